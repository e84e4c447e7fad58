"""How far two bodies overlap, and their energy, from recorded poses alone: closed forms of convex bodies against wedges.

The seats here are unions of wedges: the places inside of two planes that meet in an edge through e with the outward
normals a and b. A convex body overlaps a wedge by the least way that takes it out, which is along a normal between a
and b: -max over n of (min over the body of n . (p - e)). Nothing of the engine is used.
"""
import math

import numpy as np


def rotations(pose):
    """Rotation matrices (n, 3, 3) of poses x y z, qx qy qz qw."""
    x, y, z, w = (pose[:, 3 + i] for i in range(4))
    return np.stack([
        np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], 1),
        np.stack([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)], 1),
        np.stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], 1)], 1)


def separation(lowest, a, b):
    """Of a convex body from a wedge: lowest(n) is min over the body of n . (p - e), per pose; a unit, b unit."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    low, high = 0.0, math.acos(float(np.clip(a @ b, -1, 1)))
    across = (b - (a @ b) * a) / np.linalg.norm(b - (a @ b) * a)
    best = None
    angle = None
    for t in np.linspace(low, high, 41):  # coarse, then finer about the best of each pose
        s = lowest(np.tile(math.cos(t) * a + math.sin(t) * across, (1, 1)))
        if best is None:
            best, angle = s, np.full(s.shape, t)
        angle = np.where(s > best, t, angle)
        best = np.maximum(best, s)
    width = (high - low) / 40
    for _ in range(14):  # to 1e-8 rad
        middle = angle.copy()
        for share in np.linspace(-1, 1, 7):
            t = np.clip(middle + share * width, low, high)
            n = np.cos(t)[:, None] * a + np.sin(t)[:, None] * across
            s = lowest(n)
            angle = np.where(s > best, t, angle)
            best = np.maximum(best, s)
        width *= 0.4
    return best


def lowest_of_cylinder(pose, radius, height, e):
    R = rotations(pose)

    def lowest(n):
        n = np.broadcast_to(n, (len(pose), 3))
        along = np.einsum("ij,ij->i", n, R[:, :, 2])
        across = np.sqrt(np.maximum(0, 1 - along * along))
        return np.einsum("ij,ij->i", n, pose[:, :3] - e) - height / 2 * abs(along) - radius * across
    return lowest


def lowest_of_points(pose, points, e):
    placed = np.einsum("ijk,lk->ilj", rotations(pose), points) + (pose[:, :3] - e)[:, None, :]

    def lowest(n):
        n = np.broadcast_to(n, (len(pose), 3))
        return np.einsum("ilj,ij->il", placed, n).min(axis=1)
    return lowest


def overlap_of_cylinder_and_groove(pose, radius=0.01, height=0.03, half=0.03 / math.sqrt(2)):
    """Of the groove |x| - z < half cut into z < 0: two wedges, one on either side [m, per pose]."""
    deepest = np.full(len(pose), -np.inf)
    for side in (-1, 1):
        e = np.array([side * half, 0, 0])
        wall = np.array([-side, 0, 1]) / math.sqrt(2)
        deepest = np.maximum(deepest, -separation(lowest_of_cylinder(pose, radius, height, e), wall, (0, 0, 1)))
    return deepest


def velocities(pose, dt):
    """Linear and angular velocity (world), by central differences: of all poses but the first and the last.

    A recorded velocity is the one that led to its pose, of half a step earlier. Where a body of mass m is turned upwards
    at v, recorded pose and velocity seem to gain m g v dt. At an inelastic blow the difference is the mean of the
    velocities before and after, whose energy is not below that after.
    """
    R = rotations(pose)
    turn = np.einsum("nij,nkj->nik", R[2:], R[:-2])
    axis = np.stack([turn[:, 2, 1] - turn[:, 1, 2], turn[:, 0, 2] - turn[:, 2, 0], turn[:, 1, 0] - turn[:, 0, 1]], 1) / 2
    sine = np.linalg.norm(axis, axis=1)
    angle = np.arctan2(sine, (np.trace(turn, axis1=1, axis2=2) - 1) / 2)
    scale = np.where(sine > 0, angle / np.maximum(sine, 1e-300), 1)
    return (pose[2:, :3] - pose[:-2, :3]) / (2 * dt), axis * scale[:, None] / (2 * dt)


def box_separations(poses, side):
    """How far cubes of one size are apart in one frame, < 0: by how much they overlap: the theorem of separating axes.

    poses: (n, 7). Returns {(i, j): m} of the pairs whose enclosing balls touch.
    """
    middle, turn = poses[:, :3], rotations(poses)
    i, j = np.triu_indices(len(poses), 1)
    way = middle[j] - middle[i]
    near = (way**2).sum(axis=1) < 3 * side**2
    i, j, way = i[near], j[near], way[near]
    a, b = turn[i].transpose(0, 2, 1), turn[j].transpose(0, 2, 1)  # rows: the axes of each
    crossed = np.cross(a[:, :, None], b[:, None]).reshape(len(i), 9, 3)
    axes = np.concatenate([a, b, crossed], axis=1)
    length = np.linalg.norm(axes, axis=2)
    is_axis = length > 1e-4  # of parallel edges the others say it
    axes = axes / np.where(is_axis, length, 1)[..., None]
    reach = sum(np.abs(axes @ of.transpose(0, 2, 1)).sum(axis=2) for of in (a, b))
    apart = np.where(is_axis, np.abs((axes * way[:, None]).sum(axis=2)) - 0.5 * side * reach, -1).max(axis=1)
    return dict(zip(zip(i, j), apart))


def cylinder_energy(pose, mass, dt=0.001, radius=0.01, height=0.03, g=9.81):
    """Kinetic and potential, of all poses but the first and the last."""
    v, w_world = velocities(pose, dt)
    w = np.einsum("ikj,ik->ij", rotations(pose[1:-1]), w_world)  # in body axes
    across = mass * (3 * radius**2 + height**2) / 12
    along = mass * radius**2 / 2
    kinetic = 0.5 * mass * (v * v).sum(1) + 0.5 * (across * (w[:, 0]**2 + w[:, 1]**2) + along * w[:, 2]**2)
    return kinetic + mass * g * pose[1:-1, 2]


def half_ball_energy(pose, a, dt, g=9.81):
    """Of one kilogram, likewise, above its lowest place. Body coordinates: the ball's centre, the half below it."""
    R = rotations(pose)
    centre = np.hstack([pose[:, :3] + R @ np.array([0, 0, -3 * a / 8]), pose[:, 3:]])
    v, w_world = velocities(centre, dt)
    w = np.einsum("ikj,ik->ij", R[1:-1], w_world)
    kinetic = 0.5 * (v * v).sum(1) + 0.5 * a * a * (w**2 @ np.array([83 / 320, 83 / 320, 2 / 5]))
    return kinetic + g * (centre[1:-1, 2] - centre[:, 2].min())


def peg_points(n, chamfer_by, R=0.01, L=0.06, ch=0.001):
    """Corners of the peg of prism_entry.lua; where its lead-in is a cone, places along the edges between."""
    flats = [np.array([math.cos(2 * math.pi * i / n), math.sin(2 * math.pi * i / n)]) for i in range(n)]
    def polygon(a):
        rc = a / math.cos(math.pi / n)
        return np.array([[rc * math.cos(2 * math.pi * (i + 0.5) / n), rc * math.sin(2 * math.pi * (i + 0.5) / n)] for i in range(n)])
    def at(xy, z):
        return np.column_stack([xy, np.full(len(xy), z) if np.isscalar(z) else z])
    top = at(polygon(R), L / 2)
    if chamfer_by == "planes":
        return np.vstack([top, at(polygon(R - ch), -L / 2), at(polygon(R), -L / 2 + ch)])
    parts = [top]
    corner = polygon(R)
    low = R - ch
    for i in range(n):  # along a flat's lower edge: a hyperbola where the cone cuts it, else the bottom's straight edge
        s = np.linspace(0, 1, 101)[:, None]
        xy = corner[i] * (1 - s) + corner[(i + 1) % n] * s
        rho = np.hypot(xy[:, 0], xy[:, 1])
        parts.append(at(xy, -L / 2 + np.maximum(0, rho - low)))
    t = np.linspace(0, 2 * math.pi, 721)
    xy = low * np.column_stack([np.cos(t), np.sin(t)])
    inside = np.all([xy @ f <= R + 1e-12 for f in flats], axis=0)
    parts.append(at(xy[inside], -L / 2))
    return np.vstack(parts)


def overlap_of_prism_and_hole(pose, n, c, chamfer_by="planes", R=0.01, H=0.03):
    """Each flat of the hole is a wall with an edge above and below [m, per pose]."""
    points = peg_points(n, chamfer_by)
    deepest = np.full(len(pose), -np.inf)
    for i in range(n):
        out = np.array([math.cos(2 * math.pi * i / n), math.sin(2 * math.pi * i / n), 0])
        best = np.full(len(pose), -np.inf)
        for z in (-1, 1):
            lowest = lowest_of_points(pose, points, (R + c) * out + np.array([0, 0, z * H / 2]))
            best = np.maximum(best, separation(lowest, -out, (0, 0, z)))
        deepest = np.maximum(deepest, -best)
    return deepest

