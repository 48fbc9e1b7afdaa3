"""A mechanism that MuJoCo simulates, in our words."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from firmtouch.mechanics import Array
from firmtouch.mechanics.arrays import Vector, frozen
from firmtouch.oracle.export import MujocoExport
from firmtouch.oracle.library import NotExpressibleError, load_mujoco
from firmtouch.oracle.surfaces import JointSum

if TYPE_CHECKING:
    import mujoco


class Machine:
    """MuJoCo's model and state for an export; the one thing here that changes as it is used.

    Coordinates, forces and multipliers are in the file's order.
    """

    def __init__(self, export: MujocoExport) -> None:
        self._mujoco = load_mujoco()
        self.export = export
        try:
            self.model: mujoco.MjModel = self._mujoco.MjModel.from_xml_string(export.xml)
        except ValueError as error:
            raise NotExpressibleError(f"MuJoCo refuses the mechanism: {error}") from error
        self.data: mujoco.MjData = self._mujoco.MjData(self.model)
        # Joints of one degree of freedom: position and velocity have the same address.
        self._address = [int(self.model.joint(name).qposadr[0]) for name in export.plant.spec.coordinates]
        sums = [j for j, touch in enumerate(export.touches) if isinstance(touch, JointSum)]
        self._sums = {j: row for row, j in enumerate(sums)}  # MuJoCo's equalities come first
        contacts = [j for j in range(len(export.touches)) if j not in self._sums]
        self._balls = {self.model.geom(f"touch_{j}").id: j for j in contacts}

    @property
    def q(self) -> Array:
        """Configuration, n."""
        return frozen(self.data.qpos[self._address])

    @property
    def qdot(self) -> Array:
        """Velocity, n."""
        return frozen(self.data.qvel[self._address])

    def place(self, q: Vector, qdot: Vector) -> None:
        """Put it into a state, and evaluate everything there."""
        self.data.qpos[self._address] = q
        self.data.qvel[self._address] = qdot
        self._mujoco.mj_forward(self.model, self.data)

    def observe(self) -> None:
        """Evaluate what depends on position and velocity: the first half of a step."""
        self._mujoco.mj_step1(self.model, self.data)

    def advance(self, u: Vector) -> None:
        """Apply forces, let MuJoCo find the contact forces, and integrate: the second half of a step."""
        self.data.qfrc_applied[self._address] = u
        self._mujoco.mj_step2(self.model, self.data)

    def M(self) -> Array:
        """Inertia matrix at the present configuration, n x n, column by column."""
        columns = np.zeros((self.model.nv, self.model.nv))
        for column, unit in zip(columns, np.eye(self.model.nv), strict=True):
            self._mujoco.mj_mulM(self.model, self.data, column, unit)
        return frozen(columns.T[np.ix_(self._address, self._address)])

    def theta(self) -> Array:
        """Centrifugal, Coriolis and gravity forces of Eq. (4) at the present state, n."""
        return frozen(self.data.qfrc_bias[self._address])

    def point(self, j: int) -> Array:
        """Where the contact point of constraint j is, 3, in metres."""
        return frozen(self.data.geom(f"touch_{j}").xpos)

    def lambda_(self) -> Array:
        """Multipliers of Eq. (4) as of the last contact solution, m; zero where a contact is open."""
        values = np.zeros(len(self.export.touches))
        for j, row, scale in self._active():
            values[j] = self.data.efc_force[row] / scale
        return values

    def compliance(self) -> Array:
        """How far each constraint gives way for a multiplier of one, as MuJoCo's regularisation has it, m.

        At rest R f + d k r = 0 for the force f and the gap r, with MuJoCo's R, d and k of the contact.
        """
        values = np.zeros(len(self.export.touches))
        for j, row, scale in self._active():
            k, d = self.data.efc_KBIP[row, 0], self.data.efc_KBIP[row, 2]
            values[j] = self.data.efc_R[row] / (k * d) * scale**2
        return frozen(values)

    def _active(self) -> Iterator[tuple[int, int, float]]:
        """List (constraint, MuJoCo's row, scale): the row's gap is phi / scale, so its force is lambda * scale."""
        for j, row in self._sums.items():
            yield j, row, 1.0
        contacts = self.data.contact
        for pair, row in zip(contacts.geom.tolist(), contacts.efc_address.tolist(), strict=True):
            touch = self.export.touches[j := self._balls[pair[0] if pair[0] in self._balls else pair[1]]]
            assert not isinstance(touch, JointSum)
            if row >= 0:
                yield j, row, touch.scale
