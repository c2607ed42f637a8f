"""What can be asked of a mesh: its parts, whether they are closed, which way they face, what holds them up."""

import numpy as np
import shapely

from reasoned_explorer.rendering.mesh import Mesh


def faces(mesh: Mesh):
    """Return unit normals (m, 3) and areas (m,) of the triangles as they are wound."""
    a, b, c = (mesh.vertices[mesh.triangles[:, k]].astype(np.float64) for k in range(3))
    cross = np.cross(b - a, c - a)
    length = np.linalg.norm(cross, axis=1)
    return cross / np.maximum(length, 1e-30)[:, None], length / 2


def welded(mesh: Mesh, grid_m: float = 2e-4):
    """Return the triangles over places instead of vertices: corners at one place are one."""
    keys = np.round(mesh.vertices.astype(np.float64) / grid_m).astype(np.int64)
    _, place = np.unique(keys, axis=0, return_inverse=True)
    return place.reshape(-1)[mesh.triangles]


def parts(triangles):
    """Return for each triangle the number of the part that it belongs to: what hangs together at corners."""
    root = np.arange(triangles.max() + 1)
    while True:
        low = root[triangles].min(axis=1)
        before = root.copy()
        for k in range(3):
            np.minimum.at(root, triangles[:, k], low)
        root = root[root]
        if (root == before).all():
            break
    _, part = np.unique(root[triangles[:, 0]], return_inverse=True)
    return part.reshape(-1)


def is_closed(triangles):
    """Say whether every edge is passed once each way for each time that it is passed the other way."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    edges = edges[edges[:, 0] != edges[:, 1]].astype(np.int64)
    size = int(edges.max(initial=0)) + 1
    return bool((np.sort(edges[:, 0] * size + edges[:, 1]) == np.sort(edges[:, 1] * size + edges[:, 0])).all())


def signed_volume(mesh: Mesh, chosen):
    corners = mesh.vertices[mesh.triangles[chosen]].astype(np.float64)
    corners -= corners.reshape(-1, 3).mean(axis=0)
    return float(np.einsum("mk,mk->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))) / 6


def is_backed(mesh: Mesh, chosen, within_m: float):
    """Say whether close behind the middle of a flat one-sided part there is another face, or the ground."""
    normals, areas = faces(mesh)
    index = np.flatnonzero(chosen)
    largest = index[areas[index].argmax()]
    start = mesh.vertices[mesh.triangles[largest]].astype(np.float64).mean(axis=0)
    way = -normals[largest]
    if way[2] < -0.5 and start[2] <= within_m:
        return True
    others = ~chosen
    a, b, c = (mesh.vertices[mesh.triangles[others][:, k]].astype(np.float64) for k in range(3))
    e1, e2 = b - a, c - a
    p = np.cross(way, e2)
    det = np.einsum("mk,mk->m", e1, p)
    good = np.abs(det) > 1e-12
    inverse = np.where(good, 1 / np.where(good, det, 1), 0)
    s = start - a
    u = np.einsum("mk,mk->m", s, p) * inverse
    q = np.cross(s, e1)
    v = (q @ way) * inverse
    t = np.einsum("mk,mk->m", e2, q) * inverse
    return bool((good & (u >= -1e-6) & (v >= -1e-6) & (u + v <= 1 + 1e-6) & (t > 1e-5) & (t <= within_m)).any())


def floating(mesh: Mesh, part, gap_m: float):
    """Return the parts that neither stand on the ground nor touch (as boxes, within a gap) what does."""
    count = part.max() + 1
    corners = mesh.vertices[mesh.triangles].astype(np.float64)
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(low, part, corners.min(axis=1))
    np.maximum.at(high, part, corners.max(axis=1))
    held = low[:, 2] <= gap_m
    while True:
        loose = np.flatnonzero(~held)
        holding = np.flatnonzero(held)
        if not len(loose) or not len(holding):
            return loose
        apart = np.maximum(low[loose][:, None] - high[holding][None], low[holding][None] - high[loose][:, None])
        touching = (apart.max(axis=2) <= gap_m).any(axis=1)
        if not touching.any():
            return loose
        held[loose[touching]] = True


def seen_from(mesh: Mesh, heading_rad: float, *, samples: int = 8000, cells: int = 30):
    """Return the triangle that is nearest in each filled cell of a coarse picture without perspective.

    Points are strewn evenly over the faces that look at the viewer, who stands at a heading from the mesh, a little up.
    """
    view = np.array([np.sin(heading_rad), np.cos(heading_rad), 0.3])
    view /= np.linalg.norm(view)
    right = np.array([-np.cos(heading_rad), np.sin(heading_rad), 0.0])
    normals, areas = faces(mesh)
    weight = areas * np.maximum(normals @ view, 0)
    place = np.searchsorted(np.cumsum(weight) / weight.sum(), (np.arange(samples) + 0.5) / samples).clip(
        max=len(areas) - 1
    )
    u, v = (np.arange(samples) * 0.7548776662 % 1.0, np.arange(samples) * 0.5698402910 % 1.0)
    over = u + v > 1
    u, v = np.where(over, 1 - u, u), np.where(over, 1 - v, v)
    a, b, c = (mesh.vertices[mesh.triangles[place, k]].astype(np.float64) for k in range(3))
    points = a + u[:, None] * (b - a) + v[:, None] * (c - a)
    flat = np.column_stack([points @ right, points @ np.cross(right, view)])
    cell = (np.ptp(flat, axis=0).max() / cells) + 1e-9
    keys = np.floor((flat - flat.min(axis=0)) / cell).astype(np.int64) @ np.array([10_000, 1])
    order = np.lexsort([-(points @ view), keys])
    first = np.concatenate([[True], np.diff(keys[order]) != 0])
    return place[order[first]]


def fighting(mesh: Mesh, *, apart_m: float = 0.002, least_m2: float = 1e-4):
    """Return pairs of triangles of different looks that face one way, overlap and lie nearly in one plane, (n, 2).

    Args:
        mesh: Any.
        apart_m: Planes nearer to each other than this are one.
        least_m2: Smaller overlaps do not count.
    """
    normals, areas = faces(mesh)
    corners = mesh.vertices[mesh.triangles].astype(np.float64)
    found = [np.empty((0, 2), np.int64)]
    big = np.flatnonzero(areas > least_m2)
    keys = np.round(normals[big] * 200.0).astype(np.int64)
    _, group = np.unique(keys, axis=0, return_inverse=True)
    group = group.reshape(-1)
    order = np.argsort(group, kind="stable")
    for members in np.split(big[order], np.flatnonzero(np.diff(group[order])) + 1):
        if len(members) < 2:
            continue
        normal = normals[members[0]]
        across = np.cross(normal, (1.0, 0.0, 0.0) if abs(normal[0]) < 0.8 else (0.0, 1.0, 0.0))
        across /= np.linalg.norm(across)
        flat = np.stack([corners[members] @ across, corners[members] @ np.cross(normal, across)], axis=-1)
        high = (corners[members] @ normal).mean(axis=1)
        shapes = shapely.polygons(flat)
        one, other = shapely.STRtree(shapes).query(shapes)
        a, b = members[one], members[other]
        looks = (mesh.materials[a] != mesh.materials[b]) | (
            np.abs(mesh.colours[a] - mesh.colours[b]).max(axis=1) > 0.02
        )
        near = (one < other) & (np.abs(high[one] - high[other]) < apart_m) & looks
        one, other = one[near], other[near]
        real = shapely.area(shapely.intersection(shapes[one], shapes[other])) > least_m2
        found.append(np.column_stack([members[one[real]], members[other[real]]]))
    return np.concatenate(found)
