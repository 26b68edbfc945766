"""ROS 2 node that segments images from topics and publishes results as standard messages.

The package rclpy must be installed, usually by the user's ROS installation.
"""
