"""Input of the method: frames, cameras, and readers for files of images and intrinsics."""
