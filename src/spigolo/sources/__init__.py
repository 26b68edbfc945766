"""Sources of frames: folders, published data sets, ROS bags, cameras. Each source is an iterable of `Frame` objects.

    with sp.open_source("recording.mcap") as source:
        for frame in source:
            result = segmenter(frame)
    print(source.report())

| source | example | required extra |
|---|---|---|
| image files and folders | `recordings/` | |
| published data sets and TUM lists | `dataset:rgbd-scenes/` | |
| ROS 1 and ROS 2 bags (.bag, .db3, .mcap) | `recording.mcap` | `spigolo[bags]` |
| RealSense cameras | `realsense:` or `realsense:SERIAL` | `spigolo[realsense]` |
| RealSense recordings | `realsense:recording.db3` | `spigolo[realsense]` |
| Kinect v1, Xtion and other cameras of OpenNI2 | `openni:` or `openni:ADDRESS` | `spigolo[openni]` |
"""
