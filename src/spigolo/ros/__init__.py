"""The ROS 2 node: frames from topics, answers in standard messages. rclpy comes from the user's ROS."""
