"""Images, charts and interactive views of segmentation results."""
