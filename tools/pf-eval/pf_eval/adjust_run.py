"""All frames and points of a run adjusted together, from the matches that the run made itself.

Bundle adjustment (Triggs et al. 2000): poses x_i = (R_i, p_i) of the tracked frames and points X_j, from pixels z_ij of inliers and of corners
at their first sight,

  min sum rho(|z_ij - h(lens, R_i^T (X_j - p_i))|),   rho: Huber

by Levenberg and Marquardt, points eliminated (Schur). With the lens free, a common factor of the focal lengths and the first coefficient of
the distortion join the poses, with the priors that pf-capture gives a lens by default.
"""

import dataclasses

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.sparse import coo_matrix, csr_matrix
from scipy.spatial.transform import Rotation

from . import Refused
from .camera import Camera

HUBER_PX = 1.0
MIN_VIEWS = 3               # of a point
MIN_PARALLAX = 0.01         # [rad] between two rays of a point
MIN_PIXELS = 8              # of a frame whose pose is told
LENS_SIGMAS = (0.01, 0.05)  # of the factor of the focal lengths and of the first coefficient
MEASURED = ("inlier", "new")
EASIER, HARDER = 0.3, 5.0   # of the damping, after a step that helped, and after one that did not
DONE = 1e-7                 # of the cost, that a step gains at the end


@dataclasses.dataclass
class Problem:
    """R (n,3,3), p (n,3): poses; X (m,3): points; frame, point (k): which of them a pixel z (k,2) belongs to."""

    R: np.ndarray
    p: np.ndarray
    X: np.ndarray
    frame: np.ndarray
    point: np.ndarray
    z: np.ndarray

    def told(self):
        """Which frames have enough pixels; the poses of others stay."""
        return np.bincount(self.frame, minlength=len(self.p)) >= MIN_PIXELS


def rays(camera, pixels):
    """Unit vectors in C that project to the pixels, by Gauss and Newton from those of a pinhole."""
    a = (pixels - [camera.cx, camera.cy]) / [camera.fx, camera.fy]
    for _ in range(20):
        at = camera.project(np.column_stack([a, np.ones(len(a))]))
        J = np.stack([(camera.project(np.column_stack([a + step, np.ones(len(a))])) - at) / 1e-6
                      for step in ([1e-6, 0], [0, 1e-6])], axis=2)
        a = a + np.linalg.solve(J, (pixels - at)[:, :, None])[:, :, 0]
    d = np.column_stack([a, np.ones(len(a))])
    return d / np.linalg.norm(d, axis=1)[:, None]


def make_problem(trajectory, times, tracks, camera):
    """Of a trajectory, the times of frames by their numbers, and the table of tracks. Points where their rays come nearest."""
    number = {round(t, 6): i for i, t in enumerate(trajectory.t)}
    of_frame = {frame: number[round(t, 6)] for frame, t in times.items() if round(t, 6) in number}
    use = np.isin(tracks["status"], MEASURED) & np.isfinite(tracks["measured_u"])
    use &= np.isin(tracks["frame"], list(of_frame))
    if not use.any():
        raise Refused(f"{trajectory.source}: its frames have no matches in tracks.csv")
    frame = np.array([of_frame[int(k)] for k in tracks["frame"][use]])
    z = np.column_stack([tracks["measured_u"][use], tracks["measured_v"][use]])
    point = np.unique(tracks["id"][use], return_inverse=True)[1]
    R = trajectory.rotations()
    d_W = np.einsum("kij,kj->ki", R[frame], rays(camera, z))
    X, kept = triangulate(trajectory.p[frame], d_W, point)
    seen = kept[point]
    return Problem(R, trajectory.p.copy(), X[kept], frame[seen], (np.cumsum(kept) - 1)[point[seen]], z[seen])


def triangulate(origins, d, point):
    """(points, which of them enough rays with parallax say, before the camera): sum (I - d dT) X = sum (I - d dT) o."""
    count = point.max() + 1
    away = np.eye(3) - d[:, :, None] * d[:, None, :]
    A, b = np.zeros((count, 3, 3)), np.zeros((count, 3))
    np.add.at(A, point, away)
    np.add.at(b, point, np.einsum("kij,kj->ki", away, origins))
    mean = np.zeros((count, 3))
    np.add.at(mean, point, d)
    mean /= np.maximum(np.linalg.norm(mean, axis=1), 1e-12)[:, None]
    spread = np.zeros(count)
    np.maximum.at(spread, point, np.linalg.norm(np.cross(d, mean[point]), axis=1))
    kept = (np.bincount(point, minlength=count) >= MIN_VIEWS) & (2 * spread >= MIN_PARALLAX)
    A[~kept] = np.eye(3)
    X = np.linalg.solve(A, b[:, :, None])[:, :, 0]
    before = np.ones(count, dtype=bool)
    np.logical_and.at(before, point, np.einsum("ki,ki->k", X[point] - origins, d) > 0)
    return X, kept & before


def with_lens(camera, lens):
    factor, k1 = 1 + lens[0], lens[1]
    distortion = camera.distortion.copy()
    distortion[0] += k1
    model = "radtan" if camera.model == "none" else camera.model
    return Camera(model, camera.width, camera.height, (factor * camera.fx, factor * camera.fy, camera.cx, camera.cy), distortion)


def in_camera(problem):
    return np.einsum("kji,kj->ki", problem.R[problem.frame], problem.X[problem.point] - problem.p[problem.frame])


def residuals(problem, camera):
    return problem.z - camera.project(in_camera(problem))


def weights(r):
    """Of Huber's function, by the length of each residual; 0 where a point is behind the camera."""
    length = np.linalg.norm(r, axis=1)
    return np.where(np.isfinite(length), np.minimum(1, HUBER_PX / np.maximum(length, 1e-12)), 0)


def cost(problem, camera, lens):
    length = np.linalg.norm(residuals(problem, camera), axis=1)
    length = np.where(np.isfinite(length), length, 1e3)
    robust = np.where(length < HUBER_PX, length ** 2, 2 * HUBER_PX * length - HUBER_PX ** 2).sum()
    return robust + ((lens / LENS_SIGMAS) ** 2).sum()


def jacobians(problem, camera, lens, free_lens):
    """dh by (theta, p) of the frame (k,2,6), by the point (k,2,3), and by the lens (k,2,2): Exp(theta) R, p, X."""
    p_C = in_camera(problem)
    now = with_lens(camera, lens) if free_lens else camera
    step = 1e-6 * np.maximum(1e-3, np.linalg.norm(p_C, axis=1))[:, None]
    by_C = np.stack([(now.project(p_C + step * e) - now.project(p_C - step * e)) / (2 * step) for e in np.eye(3)], axis=2)
    R_CW = problem.R[problem.frame].transpose(0, 2, 1)
    by_X = by_C @ R_CW
    a = problem.X[problem.point] - problem.p[problem.frame]
    zero = np.zeros(len(a))
    cross = np.stack([zero, -a[:, 2], a[:, 1], a[:, 2], zero, -a[:, 0], -a[:, 1], a[:, 0], zero], axis=1).reshape(-1, 3, 3)
    by_lens = np.zeros((len(a), 2, 2))
    if free_lens:
        by_lens = np.stack([(with_lens(camera, lens + e).project(p_C) - with_lens(camera, lens - e).project(p_C)) / 2e-6
                            for e in 1e-6 * np.eye(2)], axis=2)
    return np.concatenate([by_X @ cross, -by_X], axis=2), by_X, by_lens


def step_of(problem, camera, lens, free_lens, damping):
    """(of poses (n,6), of points (m,3), of the lens) that one damped step changes."""
    now = with_lens(camera, lens) if free_lens else camera
    r = residuals(problem, now)
    w = weights(r)
    J_pose, J_point, J_lens = (np.nan_to_num(J) for J in jacobians(problem, camera, lens, free_lens))
    r = np.nan_to_num(r)
    n, m, k = len(problem.p), len(problem.X), len(r)
    dim = 6 * n + 2
    row = np.repeat(np.arange(2 * k).reshape(k, 2), 8, axis=1).reshape(k, 2, 8)
    column = np.concatenate([6 * problem.frame[:, None] + np.arange(6), np.full((k, 1), 6 * n) + np.arange(2)], axis=1)
    root = np.sqrt(w)[:, None, None]
    A = coo_matrix(((root * np.concatenate([J_pose, J_lens], axis=2)).ravel(),
                    (row.ravel(), np.repeat(column[:, None], 2, axis=1).ravel())), (2 * k, dim)).tocsr()
    row = np.repeat(np.arange(2 * k).reshape(k, 2), 3, axis=1).reshape(k, 2, 3)
    column = np.repeat((3 * problem.point[:, None] + np.arange(3))[:, None], 2, axis=1)
    B = coo_matrix(((root * J_point).ravel(), (row.ravel(), column.ravel())), (2 * k, 3 * m)).tocsr()
    b = (root[:, :, 0] * r).ravel()
    U, g = (A.T @ A).toarray(), A.T @ b
    U[range(6 * n, dim), range(6 * n, dim)] += np.array(LENS_SIGMAS) ** -2.0 if free_lens else 1.0
    if free_lens:
        g[6 * n:] -= lens / np.array(LENS_SIGMAS) ** 2
    V = np.zeros((m, 3, 3))
    np.add.at(V, problem.point, w[:, None, None] * J_point.transpose(0, 2, 1) @ J_point)
    diagonal = np.arange(3)
    V[:, diagonal, diagonal] *= 1 + damping
    V[:, diagonal, diagonal] += 1e-9 * V.trace(axis1=1, axis2=2)[:, None] + 1e-12
    U[range(dim), range(dim)] *= 1 + damping
    few = np.repeat(~problem.told(), 6)
    U[np.arange(6 * n)[few], np.arange(6 * n)[few]] += 1e12
    first = 6 * int(np.argmax(problem.told()))
    U[range(first, first + 6), range(first, first + 6)] += 1e12  # says where the world is
    inverse = np.linalg.inv(V)
    blocks = 3 * np.arange(m)[:, None, None]
    V_inverse = csr_matrix((inverse.ravel(), ((blocks + diagonal[:, None] + np.zeros((1, 3), int)).ravel(),
                                              (blocks + diagonal[None, :] + np.zeros((3, 1), int)).ravel())), (3 * m, 3 * m))
    W = A.T @ B
    WV = W @ V_inverse
    g_point = B.T @ b
    S = U - (WV @ W.T).toarray()
    try:
        dx = cho_solve(cho_factor(S), g - WV @ g_point)
    except np.linalg.LinAlgError:
        return None
    dX = V_inverse @ (g_point - W.T @ dx)
    return dx[:6 * n].reshape(n, 6), dX.reshape(m, 3), dx[6 * n:] if free_lens else np.zeros(2)


def adjust(problem, camera, free_lens, rounds, say=lambda text: None):
    """(adjusted problem, camera): changes nothing of what it is given. Ends where a step gains nothing any more, or after the rounds."""
    lens, damping = np.zeros(2), 1e-4
    best = cost(problem, with_lens(camera, lens) if free_lens else camera, lens)
    for round_ in range(rounds):
        step = step_of(problem, camera, lens, free_lens, damping)
        gained = 0.0
        if step is not None:
            dx, dX, dlens = step
            turned = Rotation.from_rotvec(dx[:, :3]).as_matrix() @ problem.R
            tried = dataclasses.replace(problem, R=turned, p=problem.p + dx[:, 3:], X=problem.X + dX)
            after = cost(tried, with_lens(camera, lens + dlens) if free_lens else camera, lens + dlens)
            gained = best - after
        if gained > 0:
            problem, lens, best = tried, lens + dlens, after
        damping *= EASIER if gained > 0 else HARDER
        say(f"round {round_ + 1} of at most {rounds}: cost {best:.1f}")
        if 0 < gained < DONE * best or damping > 1e9:
            break
    return problem, with_lens(camera, lens) if free_lens else camera
