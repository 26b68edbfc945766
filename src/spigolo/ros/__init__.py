"""ROS 2 node: frames from topics, results in standard messages. rclpy comes from the user's ROS installation."""
