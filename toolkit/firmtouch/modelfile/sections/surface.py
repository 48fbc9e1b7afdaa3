"""stub"""
from __future__ import annotations
from typing import Annotated
from pydantic import Field
from firmtouch.modelfile.fields import Expression
from firmtouch.modelfile.fields.constant import constant_in, vector_in
from firmtouch.modelfile.sections.section import Section

class PlaneSpec(Section):
    point: Annotated[Expression, vector_in("m")]
    normal: Annotated[Expression, vector_in("1")]

class SphereSpec(Section):
    centre: Annotated[Expression, vector_in("m")]
    radius: Annotated[Expression, constant_in("m")]

class SurfaceSpec(Section):
    plane: PlaneSpec | None = None
    sphere: SphereSpec | None = None

    @property
    def kind(self):
        return "plane" if self.plane else "sphere"
