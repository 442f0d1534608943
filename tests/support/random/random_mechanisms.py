"""Random mechanisms: legs of random bodies and joints between the ground and a platform.

Postures differ from the reference posture: every body has its own rotation.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from lumped.legs import ConstantLeg, Material
from lumped.mechanism.body import Body, Frame, Rigid, Shape
from lumped.mechanism.joint import AXES, Drive, Joint, JointKind, Side
from lumped.mechanism.mechanism import GROUND, Mechanism, Posture, Tool
from lumped.sections import Circle, HollowRectangle, Rectangle, Tube

SECTIONS = (
    Rectangle(0.05, 0.03),
    HollowRectangle(0.06, 0.04, 0.004),
    Circle(0.04),
    Tube(0.05, 0.004),
)
STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
Z = np.array([0.0, 0.0, 1.0])


class Maker:
    """Builder of a mechanism from bodies and joints, with positions and axes of the posture."""

    def __init__(self, rng: np.random.Generator, *, planar: bool = False) -> None:
        self.rng, self.planar = rng, planar
        self.bodies = {GROUND: Body(GROUND, Rigid(), {})}
        self.frames, self.reference = {GROUND: Frame()}, {GROUND: Frame()}
        self.joints: list[Joint] = []

    def direction(self) -> np.ndarray:
        vector = self.rng.normal(size=3) * ([1.0, 1.0, 0.0] if self.planar else 1.0)
        return vector / np.linalg.norm(vector)

    def rotation(self, x: np.ndarray) -> np.ndarray:
        """Random axes (3×3, columns) with the given x axis."""
        y = np.cross(Z if self.planar else self.rng.normal(size=3), x)
        y /= np.linalg.norm(y)
        return np.column_stack([x, y, np.cross(x, y)])

    def body(self, name: str, shape: Shape, frame: Frame, points: dict[str, np.ndarray]) -> None:
        """Add a body with interfaces at `points` (base axes)."""
        inverse = frame.inverse()
        self.bodies[name] = Body(
            name, shape, {key: inverse @ Frame(point) for key, point in points.items()}
        )
        self.frames[name] = frame
        axis = Z if self.planar else self.direction()
        turned = Rotation.from_rotvec(self.rng.uniform(-2, 2) * axis).as_matrix()
        self.reference[name] = Frame(frame.position, turned.T @ frame.rotation)

    def leg(self, name: str, first: str, second: str, ends: np.ndarray) -> None:
        """Add a prism, or a leg known by its 6×6, between the points `ends` (2×3)."""
        length = float(np.linalg.norm(ends[1] - ends[0]))
        frame = Frame(ends[0], self.rotation((ends[1] - ends[0]) / length))
        prism = ConstantLeg(length, SECTIONS[self.rng.integers(len(SECTIONS))], STEEL)
        self.body(name, prism, frame, {first: ends[0], second: ends[1]})

    def joint(
        self,
        kind: JointKind,
        sides: tuple[tuple[str, str], tuple[str, str]],
        drive: Drive | None = None,
        compliance: np.ndarray | None = None,
    ) -> None:
        """Add a joint with random axes (base axes of the posture)."""
        first, second = (Side(*side) for side in sides)
        axes = []
        for number in range(AXES[kind]):
            turning = kind != "prismatic"
            axis = Z if self.planar and turning else self.direction()
            # Given in the reference posture, from which the axis has turned with its body.
            body = (first if number == 0 else second).body
            since = self.frames[body].rotation @ self.reference[body].rotation.T
            axes.append(since.T @ axis)
        rows, name = np.array(axes).reshape(-1, 3), f"j{len(self.joints)}"
        self.joints.append(Joint(name, kind, first, second, rows, drive, compliance))

    def compliance(self) -> np.ndarray:
        """Random compliance (6×6) of a joint: positive definite, as large as that of a bearing."""
        root = self.rng.normal(size=(6, 6))
        return 1e-9 * (root @ root.T + np.eye(6))

    def posture(self, tool: Tool) -> Posture:
        mechanism = Mechanism(
            "random", self.bodies, tuple(self.joints), tool, self.reference, np.zeros((1, 0))
        )
        return Posture(mechanism, np.zeros(0), self.frames, {})


def random_posture(seed: int, *, planar: bool = False, rigid: float = 0.2) -> Posture:
    """Posture of one to four serial legs of one to three bodies each, with a rigid platform.

    `rigid` is the fraction of rigid bodies. The mechanism may be movable, overconstrained or
    neither.
    """
    rng = np.random.default_rng(seed)
    make = Maker(rng, planar=planar)
    kinds = ("fixed", "revolute", "prismatic") if planar else tuple(AXES)
    chances = None if planar else [0.1, 0.3, 0.1, 0.1, 0.15, 0.15, 0.1]
    counts = rng.integers(1, 4, size=rng.integers(1, 5))
    centre = np.array([0.1, 0.2, 0.0 if planar else 0.6])
    corners = {f"{leg}.{n}": centre + 0.2 * make.direction() for leg, n in enumerate(counts)}
    ground = {f"{leg}.0": centre + 0.7 * make.direction() for leg in range(len(counts))}
    make.bodies[GROUND] = Body(GROUND, Rigid(), {k: Frame(p) for k, p in ground.items()})
    shape = Rigid(5.0, np.array([0.0, 0.01, 0.02]), np.diag([0.1, 0.2, 0.3]))
    frame = Frame(centre, make.rotation(make.direction()))
    tip = centre + np.array([0.05, -0.03, 0.0])
    make.body("platform", shape, frame, {"T": tip, **corners})

    def join(before: str, after: str, point: str) -> None:
        kind = kinds[int(rng.choice(len(kinds), p=chances))]
        drive = None
        if kind in ("revolute", "prismatic", "cylindrical") and rng.random() < 0.5:
            drive = Drive(None if rng.random() < 0.3 else 10.0 ** rng.uniform(5, 8))
        give = make.compliance() if rng.random() < 0.3 else None
        make.joint(kind, ((before, point), (after, point)), drive, give)

    for leg, count in enumerate(counts):
        joints_of_leg = np.linspace(ground[f"{leg}.0"], corners[f"{leg}.{count}"], count + 1)
        joints_of_leg[1:-1] += 0.2 * np.array(
            [make.direction() for _ in joints_of_leg[1:-1]]
        ).reshape(-1, 3)
        before = GROUND
        for number in range(count):
            name, ends = f"body {leg}.{number}", joints_of_leg[number : number + 2]
            points = f"{leg}.{number}", f"{leg}.{number + 1}"
            if rng.random() < rigid:
                shape = Rigid(2.0, rng.normal(size=3) * 0.1, 0.02 * np.eye(3))
                frame = Frame(ends[0], make.rotation(make.direction()))
                make.body(name, shape, frame, dict(zip(points, ends, strict=True)))
            else:
                make.leg(name, *points, ends)
            join(before, name, points[0])
            before = name
        join(before, "platform", f"{leg}.{count}")
    return make.posture(Tool("platform", "T", mass=3.0))
