"""Output of the method: measurements of regions, reasons for the rejection of regions, and the segmentation result."""
