"""3-D scene of the tuning page. The scene contains a picture of the frame, and its point cloud with boxes. Each browser
window has its own camera in the scene.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from spigolo.frames.frame import Color, Frame
from spigolo.objects.boxes import OrientedBox
from spigolo.objects.facts import RegionFacts
from spigolo.view import tuning_scene as scene
from spigolo.view.tuning_session import Answer, Pixel

if TYPE_CHECKING:
    import viser


class Space:
    """3-D scene with the picture and the point cloud of the current frame. A click on the picture or the cloud selects
    a pixel.
    """

    def __init__(self, server: viser.ViserServer, select: Callable[[Pixel | None], None]) -> None:
        self.stand: scene.Stand | None = None
        """Positions of the picture and the point cloud in the scene. The value is None before the first frame is shown.
        """
        self._server, self._select = server, select
        self._frame: Frame | None = None
        server.scene.set_up_direction("-y")
        server.scene.on_click()(self._clicked)
        server.on_client_connect(lambda client: self.look(client, "both"))

    def show(self, answer: Answer, stage: str, chosen: RegionFacts | None, boxes: Sequence[OrientedBox | None]) -> None:
        """Show one of the images (`STAGES`) as the picture, and the point cloud with the oriented box of each object.
        The object or region `chosen` is highlighted in the picture and in the point cloud.
        """
        self._show_picture(scene.picture(answer, stage, chosen), answer.run.frame)
        self._show_cloud(answer, chosen, boxes)

    def look(self, client: viser.ClientHandle, view: str) -> None:
        """Point the camera of a browser window at a part of the scene.

        view: part of the scene to look at, "picture", "cloud" or "both".
        """
        if self.stand is None:
            return
        position, target = self.stand.look(view, client.camera.aspect)
        with client.atomic():
            client.camera.fov = scene.FOV
            client.camera.up_direction = (0.0, -1.0, 0.0)
            client.camera.position = position
            client.camera.look_at = target

    def _show_picture(self, picture: Color, frame: Frame) -> None:
        if frame is not self._frame:
            before, self._frame = self.stand, frame
            self.stand = scene.stand_of(frame)
            self._board = self._server.scene.add_image(
                "/picture", picture, *self.stand.size, format="jpeg", jpeg_quality=88, position=self.stand.board
            )
            if before is None:
                for client in self._server.get_clients().values():
                    self.look(client, "both")
            return
        self._board.image = picture

    def _show_cloud(self, answer: Answer, chosen: RegionFacts | None, boxes: Sequence[OrientedBox | None]) -> None:
        assert self.stand is not None
        add = self._server.scene
        if not len(self.stand.points):
            return
        colors = scene.cloud_colors(answer, self.stand, chosen)
        size = float(self.stand.size[0]) / 260
        add.add_point_cloud("/cloud", self.stand.points, colors, point_size=size, point_shape="rounded")
        ends, tints = scene.box_lines(boxes)
        if len(ends):
            add.add_line_segments("/boxes", ends, tints, thickness=2.5, thickness_units="screen")
        else:
            add.remove_by_name("/boxes")

    def _clicked(self, event: viser.SceneClickEvent) -> None:
        if self.stand is not None:
            origin, direction = np.array(event.ray_origin), np.array(event.ray_direction)
            self._select(self.stand.pixel_at(origin, direction))
