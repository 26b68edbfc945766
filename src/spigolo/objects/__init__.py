"""Output of the method: measured regions, reasons for rejection, and the segmentation result."""
