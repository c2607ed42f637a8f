"""The simulated body and its sensors, compiled: keyed draws, motion, contact, and a whole leg in one call.

Small float64 arrays hold what belongs together; the constants below name their slots. The follower and the filter are
those of `vehicles.control`: what is simulated here is only what a real machine would bring, its body and its sensors.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from reasoned_explorer.vehicles.control.kernels import (
    EKF_GYRO_BIAS,
    EKF_HEADING,
    EKF_X,
    EKF_Y,
    MEM_FORWARD,
    MEM_RATE,
    MEM_RIGHT,
    MEM_START_X,
    MEM_START_Y,
    MEM_TARGET_X,
    MEM_TARGET_Y,
    PHASE_ARRIVED,
    PHASE_DRIVE,
    PHASE_STUCK,
    filter_compass,
    filter_odometry,
    filter_position,
    filter_predict,
    filter_velocity,
    follower_step,
    turned,
    wrap_bearing,
)

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Codes = NDArray[np.uint8]

# --- what is true of the body, and its sensors' slow errors --------------------------------------------------------
(
    TRUE_X,
    TRUE_Y,
    TRUE_HEADING,
    TRUE_VX,
    TRUE_VY,
    TRUE_FORWARD,
    TRUE_RIGHT,
    TRUE_RATE,
    TRUE_SWAY_X,
    TRUE_SWAY_Y,
    TRUE_BIAS,
    TRUE_WANDER_X,
    TRUE_WANDER_Y,
    TRUE_COMPASS,
    TRUE_SCALE,
    TRUE_GAP_S,
) = range(16)
TRUE_SIZE = 16

# --- what the body can do ------------------------------------------------------------------------------------------
(
    BODY_SPEED,
    BODY_ACCELERATION,
    BODY_TURN_RATE,
    BODY_TURN_ACCELERATION,
    BODY_LAG_S,
    BODY_SWAY,
    BODY_SWAY_TAU,
    BODY_RADIUS,
    BODY_COLLIDES,
    BODY_SIDEWAYS,
) = range(10)
BODY_SIZE = 10

# --- how its sensors err, and what the filter is told of that --------------------------------------------------------
(
    NOISE_POSITION,
    NOISE_VELOCITY,
    NOISE_WANDER,
    NOISE_WANDER_TAU,
    NOISE_FIX_EVERY,
    NOISE_GYRO,
    NOISE_BIAS_WALK,
    NOISE_ACCELERATION,
    NOISE_COMPASS,
    NOISE_COMPASS_WANDER,
    NOISE_COMPASS_TAU,
    NOISE_COMPASS_EVERY,
    NOISE_ODOMETRY,
    NOISE_ODOMETRY_SCALE,
    NOISE_ODOMETRY_EVERY,
    NOISE_OUTLIER_SHARE,
    NOISE_OUTLIER_M,
    NOISE_GAP_SHARE,
    NOISE_GAP_S,
    TOLD_POSITION,
    TOLD_VELOCITY,
    TOLD_ODOMETRY,
    TOLD_COMPASS,
) = range(23)
NOISE_SIZE = 23

# --- how a leg ended, and what is counted on it ----------------------------------------------------------------------
END_NONE, END_ARRIVED, END_STUCK, END_TIME, END_WALL, END_DISC, END_GROUND, END_EDGE = range(8)
(
    TALLY_END,
    TALLY_HIT,
    TALLY_TICKS,
    TALLY_LENGTH,
    TALLY_CROSS_SQUARES,
    TALLY_DRIVEN,
    TALLY_ERROR_SQUARES,
    TALLY_REFUSED,
) = range(8)
TALLY_SIZE = 8

#: After a contact the body backs off, at this speed and for so long: about a hand's breadth.
RECOIL_MPS, RECOIL_S = 0.2, 0.6
#: It stops this far before what it would touch.
STANDOFF_M = 0.005
#: A point of the track is kept after so many metres, or after so many seconds in which it moved or turned a little.
TRACK_M, TRACK_S, TRACK_LEAST_M, TRACK_LEAST_RAD = 1.0, 0.5, 0.5, 0.1

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_PART = np.uint64(0xD1342543DE82EF95)
_MIX_A = np.uint64(0xBF58476D1CE4E5B9)
_MIX_B = np.uint64(0x94D049BB133111EB)
_S11, _S27, _S30, _S31 = np.uint64(11), np.uint64(27), np.uint64(30), np.uint64(31)
_UNIT = 1.0 / (1 << 53)
_TAU = 2.0 * math.pi

# Channels of draws within a tick.
_GYRO, _PUSH, _FIX, _DOPPLER, _WANDER, _FATE, _ODOMETRY, _COMPASS, _COMPASS_WANDER, _SWAY, _BIAS = range(11)


# === keyed draws =====================================================================================================


@njit(cache=True, error_model="numpy")
def mix(state: np.uint64) -> np.uint64:
    """Return the finaliser of SplitMix64, as `model.draws` has it."""
    state = (state ^ (state >> _S30)) * _MIX_A
    state = (state ^ (state >> _S27)) * _MIX_B
    return state ^ (state >> _S31)


@njit(cache=True, error_model="numpy")
def chain(key: np.uint64, part: int) -> np.uint64:
    """Return ``draws.key_of(seed, *keys, part)`` for ``key = draws.key_of(seed, *keys)``."""
    mixed: np.uint64 = mix(key + _GOLDEN + np.uint64(part) * _PART)
    return mixed


@njit(cache=True, error_model="numpy")
def unit(key: np.uint64) -> float:
    """Return the uniform number in [0, 1) of a key: ``draws.uniform``."""
    return np.float64(key >> _S11) * _UNIT


@njit(cache=True, error_model="numpy")
def normals(key: np.uint64) -> tuple[float, float]:
    """Return two independent standard normal numbers of a key; the first is ``draws.normal``."""
    radius = math.sqrt(-2.0 * math.log(1.0 - unit(key)))
    angle = _TAU * unit(mix(key + _GOLDEN))
    return radius * math.cos(angle), radius * math.sin(angle)


# === contact =========================================================================================================


@njit(cache=True, error_model="numpy")
def wall_distance(walls: Floats, row: int, x_m: float, y_m: float) -> float:
    """Return the distance from a point to a wall."""
    ax, ay = walls[row, 0], walls[row, 1]
    dx, dy = walls[row, 2] - ax, walls[row, 3] - ay
    square = dx * dx + dy * dy
    share = 0.0
    if square > 0.0:
        share = min(1.0, max(0.0, ((x_m - ax) * dx + (y_m - ay) * dy) / square))
    return math.hypot(ax + share * dx - x_m, ay + share * dy - y_m)


@njit(cache=True, error_model="numpy")
def disc_distance(discs: Floats, row: int, x_m: float, y_m: float) -> float:
    """Return the distance from a point to a disc's rim, negative within it."""
    distance: float = math.hypot(discs[row, 0] - x_m, discs[row, 1] - y_m) - discs[row, 2]
    return distance


@njit(cache=True, error_model="numpy")
def clearance(walls: Floats, discs: Floats, x_m: float, y_m: float) -> float:
    """Return the distance from a point to the nearest obstacle; infinite without any."""
    least: float = math.inf
    for row in range(walls.shape[0]):
        least = min(least, wall_distance(walls, row, x_m, y_m))
    for row in range(discs.shape[0]):
        least = min(least, disc_distance(discs, row, x_m, y_m))
    return least


@njit(cache=True, error_model="numpy")
def _distance(walls: Floats, discs: Floats, item: int, x_m: float, y_m: float) -> float:
    """Return the distance to an obstacle: a wall, or a disc for items from the number of walls on."""
    if item < walls.shape[0]:
        distance: float = wall_distance(walls, item, x_m, y_m)
    else:
        distance = disc_distance(discs, item - walls.shape[0], x_m, y_m)
    return distance


@njit(cache=True, error_model="numpy")
def first_touch(
    walls: Floats, discs: Floats, x0_m: float, y0_m: float, x1_m: float, y1_m: float, radius_m: float
) -> tuple[float, int]:
    """Return (share of a short move that is free, obstacle that ends it or -1).

    An obstacle ends a move that brings the body nearer to it than its radius. What the body already touches does not
    hold it back from moving away. The move must be shorter than the radius.
    """
    best, hit = 1.0, -1
    for item in range(walls.shape[0] + discs.shape[0]):
        after = _distance(walls, discs, item, x1_m, y1_m)
        if after >= radius_m:
            continue
        before = _distance(walls, discs, item, x0_m, y0_m)
        if after >= before:
            continue
        low, high = 0.0, 1.0
        if before <= radius_m:
            high = 0.0
        else:
            for _ in range(24):
                middle = 0.5 * (low + high)
                x, y = x0_m + middle * (x1_m - x0_m), y0_m + middle * (y1_m - y0_m)
                if _distance(walls, discs, item, x, y) >= radius_m:
                    low = middle
                else:
                    high = middle
            high = low
        if hit < 0 or high < best:
            best, hit = high, item
    return best, hit


@njit(cache=True, error_model="numpy")
def ground_code(codes: Codes, ground: Floats, x_m: float, y_m: float) -> int:
    """Return the code of the ground at a point; 0 (unknown) beyond the raster. ``ground``: min x, min y, cell."""
    column = math.floor((x_m - ground[0]) / ground[2])
    row = math.floor((y_m - ground[1]) / ground[2])
    if row < 0 or column < 0 or row >= codes.shape[0] or column >= codes.shape[1]:
        return 0
    return int(codes[row, column])


@njit(cache=True, error_model="numpy")
def _within(bounds: Floats, x_m: float, y_m: float) -> bool:
    return bool(bounds[0] <= x_m <= bounds[2] and bounds[1] <= y_m <= bounds[3])


@njit(cache=True, error_model="numpy")
def _first_contact(
    x0_m: float,
    y0_m: float,
    x1_m: float,
    y1_m: float,
    body: Floats,
    walls: Floats,
    discs: Floats,
    codes: Codes,
    blocked: NDArray[np.bool_],
    ground: Floats,
    bounds: Floats,
    near: bool,
) -> tuple[float, int, int]:
    """Return (free share of a move, how it ends, what ends it): a wall, a disc, ground, the edge, or nothing."""
    length, radius = math.hypot(x1_m - x0_m, y1_m - y0_m), body[BODY_RADIUS]
    if length == 0.0:
        return 1.0, END_NONE, -1
    steps = max(1, math.ceil(2.0 * length / radius))
    toe_x, toe_y = (x1_m - x0_m) / length * radius, (y1_m - y0_m) / length * radius
    for step in range(steps):
        ax, ay = x0_m + (x1_m - x0_m) * step / steps, y0_m + (y1_m - y0_m) * step / steps
        bx, by = x0_m + (x1_m - x0_m) * (step + 1) / steps, y0_m + (y1_m - y0_m) * (step + 1) / steps
        if not _within(bounds, bx, by) and _within(bounds, ax, ay):
            return step / steps, END_EDGE, -1
        if body[BODY_COLLIDES] == 0.0:
            continue
        if near:
            share, hit = first_touch(walls, discs, ax, ay, bx, by, radius)
            if hit >= 0:
                free = max(0.0, (step + share) / steps - STANDOFF_M / length)
                if hit < walls.shape[0]:
                    return free, END_WALL, hit
                return free, END_DISC, hit - walls.shape[0]
        ahead = ground_code(codes, ground, bx + toe_x, by + toe_y)
        if blocked[ahead] and not blocked[ground_code(codes, ground, ax, ay)]:
            return step / steps, END_GROUND, ahead
    return 1.0, END_NONE, -1


# === body and sensors ================================================================================================


@njit(cache=True, error_model="numpy")
def _move(
    true: Floats, body: Floats, key: np.uint64, forward_mps: float, right_mps: float, rate_radps: float, dt_s: float
) -> None:
    """Carry the body over a tick: it follows a command with a lag, within its limits, and sways while it moves."""
    follow = 1.0 - math.exp(-dt_s / body[BODY_LAG_S])
    most = body[BODY_TURN_ACCELERATION] * dt_s
    rate = true[TRUE_RATE] + min(most, max(-most, (rate_radps - true[TRUE_RATE]) * follow))
    rate = min(body[BODY_TURN_RATE], max(-body[BODY_TURN_RATE], rate))
    turn = 0.5 * (rate + true[TRUE_RATE]) * dt_s
    heading = wrap_bearing(true[TRUE_HEADING] + turn)
    true[TRUE_RATE] = rate
    if body[BODY_SIDEWAYS] > 0.0:
        # What flies keeps its velocity over ground when it turns; what walks turns it along.
        true[TRUE_FORWARD], true[TRUE_RIGHT] = turned(true[TRUE_FORWARD], true[TRUE_RIGHT], turn)
    gap_forward = (forward_mps - true[TRUE_FORWARD]) * follow
    gap_right = (right_mps - true[TRUE_RIGHT]) * follow
    gap = math.hypot(gap_forward, gap_right)
    most = body[BODY_ACCELERATION] * dt_s
    if gap > most:
        gap_forward, gap_right = gap_forward * most / gap, gap_right * most / gap
    true[TRUE_FORWARD] += gap_forward
    true[TRUE_RIGHT] += gap_right
    if body[BODY_SWAY] > 0.0:
        keep = math.exp(-dt_s / body[BODY_SWAY_TAU])
        fresh = body[BODY_SWAY] * math.sqrt(1.0 - keep * keep)
        push_x, push_y = normals(chain(key, _SWAY))
        true[TRUE_SWAY_X] = keep * true[TRUE_SWAY_X] + fresh * push_x
        true[TRUE_SWAY_Y] = keep * true[TRUE_SWAY_Y] + fresh * push_y
    moving = min(1.0, math.hypot(true[TRUE_FORWARD], true[TRUE_RIGHT]) / body[BODY_SPEED])
    sin_h, cos_h = math.sin(heading), math.cos(heading)
    vx = true[TRUE_FORWARD] * sin_h + true[TRUE_RIGHT] * cos_h + moving * true[TRUE_SWAY_X]
    vy = true[TRUE_FORWARD] * cos_h - true[TRUE_RIGHT] * sin_h + moving * true[TRUE_SWAY_Y]
    true[TRUE_X] += 0.5 * (vx + true[TRUE_VX]) * dt_s
    true[TRUE_Y] += 0.5 * (vy + true[TRUE_VY]) * dt_s
    true[TRUE_VX], true[TRUE_VY], true[TRUE_HEADING] = vx, vy, heading


@njit(cache=True, error_model="numpy")
def wander(true: Floats, noise: Floats, key: np.uint64, dt_s: float) -> None:
    """Carry the slow errors of receiver, compass and gyro over some time (exact for Gauss-Markov processes)."""
    keep = math.exp(-dt_s / noise[NOISE_WANDER_TAU])
    fresh = noise[NOISE_WANDER] * math.sqrt(1.0 - keep * keep)
    east, north = normals(chain(key, _WANDER))
    true[TRUE_WANDER_X] = keep * true[TRUE_WANDER_X] + fresh * east
    true[TRUE_WANDER_Y] = keep * true[TRUE_WANDER_Y] + fresh * north
    keep = math.exp(-dt_s / noise[NOISE_COMPASS_TAU])
    fresh = noise[NOISE_COMPASS_WANDER] * math.sqrt(1.0 - keep * keep)
    compass, bias = normals(chain(key, _COMPASS_WANDER))
    true[TRUE_COMPASS] = keep * true[TRUE_COMPASS] + fresh * compass
    true[TRUE_BIAS] += noise[NOISE_BIAS_WALK] * math.sqrt(dt_s) * bias


@njit(cache=True, error_model="numpy")
def _satellites(
    true: Floats,
    noise: Floats,
    key: np.uint64,
    since_s: float,
    settings: Floats,
    state: Floats,
    cov: Floats,
    rejects: Ints,
    work: Floats,
) -> int:
    """Take a fix, or none in a gap, and return how many measurements the filter refused."""
    fate_key = chain(key, _FATE)
    fate, fate_more = unit(fate_key), unit(mix(fate_key + _GOLDEN))
    if true[TRUE_GAP_S] > 0.0:
        true[TRUE_GAP_S] -= since_s
        return 0
    if fate < noise[NOISE_GAP_SHARE]:
        true[TRUE_GAP_S] = -noise[NOISE_GAP_S] * math.log(1.0 - fate_more)
        return 0
    east, north = normals(chain(key, _FIX))
    x = true[TRUE_X] + true[TRUE_WANDER_X] + noise[NOISE_POSITION] * east
    y = true[TRUE_Y] + true[TRUE_WANDER_Y] + noise[NOISE_POSITION] * north
    if fate > 1.0 - noise[NOISE_OUTLIER_SHARE]:
        x += noise[NOISE_OUTLIER_M] * math.sin(_TAU * fate_more)
        y += noise[NOISE_OUTLIER_M] * math.cos(_TAU * fate_more)
    refused = 0
    if not filter_position(settings, state, cov, rejects, work, x, y, noise[TOLD_POSITION]):
        refused += 1
    east, north = normals(chain(key, _DOPPLER))
    vx, vy = true[TRUE_VX] + noise[NOISE_VELOCITY] * east, true[TRUE_VY] + noise[NOISE_VELOCITY] * north
    if not filter_velocity(settings, state, cov, rejects, work, vx, vy, noise[TOLD_VELOCITY]):
        refused += 1
    return refused


@njit(cache=True, error_model="numpy")
def _sense(
    true: Floats,
    noise: Floats,
    key: np.uint64,
    tick: int,
    turned_rad: float,
    ax_mps2: float,
    ay_mps2: float,
    settings: Floats,
    state: Floats,
    cov: Floats,
    rejects: Ints,
    work: Floats,
    dt_s: float,
) -> tuple[float, int]:
    """Let the sensors measure a tick and the filter take it in; return (gyro rate, refused measurements)."""
    root = math.sqrt(dt_s)
    gyro_noise, _ = normals(chain(key, _GYRO))
    gyro = turned_rad / dt_s + true[TRUE_BIAS] + noise[NOISE_GYRO] / root * gyro_noise
    push_forward, push_right = normals(chain(key, _PUSH))
    middle = true[TRUE_HEADING] - 0.5 * turned_rad
    sin_h, cos_h = math.sin(middle), math.cos(middle)
    forward = ax_mps2 * sin_h + ay_mps2 * cos_h + noise[NOISE_ACCELERATION] / root * push_forward
    right = ax_mps2 * cos_h - ay_mps2 * sin_h + noise[NOISE_ACCELERATION] / root * push_right
    filter_predict(settings, state, cov, dt_s, gyro, forward, right)
    refused = 0
    every = int(noise[NOISE_ODOMETRY_EVERY])
    if tick % every == every - 1:
        sin_h, cos_h = math.sin(true[TRUE_HEADING]), math.cos(true[TRUE_HEADING])
        slip_forward, slip_right = normals(chain(key, _ODOMETRY))
        ahead = true[TRUE_VX] * sin_h + true[TRUE_VY] * cos_h
        aside = true[TRUE_VX] * cos_h - true[TRUE_VY] * sin_h
        ahead = ahead * true[TRUE_SCALE] + noise[NOISE_ODOMETRY] * slip_forward
        aside = aside * true[TRUE_SCALE] + noise[NOISE_ODOMETRY] * slip_right
        told = math.hypot(noise[TOLD_ODOMETRY], noise[NOISE_ODOMETRY_SCALE] * math.hypot(ahead, aside))
        if not filter_odometry(settings, state, cov, rejects, work, ahead, aside, told):
            refused += 1
    every = int(noise[NOISE_COMPASS_EVERY])
    if tick % every == every - 1:
        needle, _ = normals(chain(key, _COMPASS))
        heading = true[TRUE_HEADING] + true[TRUE_COMPASS] + noise[NOISE_COMPASS] * needle
        if not filter_compass(settings, state, cov, rejects, work, heading, noise[TOLD_COMPASS]):
            refused += 1
    every = int(noise[NOISE_FIX_EVERY])
    if tick % every == every - 1:
        wander(true, noise, key, every * dt_s)
        refused += _satellites(true, noise, key, every * dt_s, settings, state, cov, rejects, work)
    return gyro, refused


# === a leg ===========================================================================================================


@njit(cache=True, error_model="numpy")
def _keep_point(record: Floats, count: int, t_s: float, true: Floats) -> int:
    row: int = min(count, record.shape[0] - 1)
    record[row, 0], record[row, 1], record[row, 2] = t_s, true[TRUE_X], true[TRUE_Y]
    record[row, 3] = true[TRUE_HEADING]
    return row + 1


@njit(cache=True, error_model="numpy")
def _off_line(memory: Floats, x_m: float, y_m: float) -> float:
    """Return the distance of a point from the line that the follower is to keep."""
    line_x, line_y = memory[MEM_TARGET_X] - memory[MEM_START_X], memory[MEM_TARGET_Y] - memory[MEM_START_Y]
    length = math.hypot(line_x, line_y)
    if length == 0.0:
        return 0.0
    off: float = ((y_m - memory[MEM_START_Y]) * line_x - (x_m - memory[MEM_START_X]) * line_y) / length
    return off


@njit(cache=True, error_model="numpy")
def run_leg(
    base: np.uint64,
    true: Floats,
    body: Floats,
    noise: Floats,
    settings: Floats,
    state: Floats,
    cov: Floats,
    rejects: Ints,
    work: Floats,
    follow: Floats,
    gains: Floats,
    memory: Floats,
    walls: Floats,
    discs: Floats,
    codes: Codes,
    blocked: NDArray[np.bool_],
    ground: Floats,
    bounds: Floats,
    dt_s: float,
    max_ticks: int,
    stand_ticks: int,
    record: Floats,
    tally: Floats,
) -> int:
    """Run a leg that `follower_start` has set off, to its end and a while of standing; return the points recorded.

    After a contact the body backs off a little, so that it is free to go on in another direction. Arrays are changed in
    place. ``record`` has rows (seconds since the start, x, y, heading) and gets both ends;
    ``tally`` is filled as the TALLY constants say. The draws of a tick are keyed by ``base`` and the tick's number.
    """
    end, hit, standing = END_NONE, -1, 0
    length, cross, driven, error, refused = 0.0, 0.0, 0, 0.0, 0
    back_x, back_y = 0.0, 0.0
    free_m = 0.0
    rate = 0.0
    count: int = _keep_point(record, 0, 0.0, true)
    kept_t, kept_length = 0.0, 0.0
    tick = 0
    while True:
        if end == END_NONE:
            phase = follower_step(
                follow, gains, memory, state[EKF_X], state[EKF_Y], state[EKF_HEADING], rate - state[EKF_GYRO_BIAS], dt_s
            )
            if phase == PHASE_ARRIVED:
                end = END_ARRIVED
            elif phase == PHASE_STUCK:
                end = END_STUCK
            elif tick >= max_ticks:
                end = END_TIME
        else:
            phase = -1
        if end != END_NONE:
            if standing == 0 and tick * dt_s > record[count - 1, 0]:
                # Where it came to rest, and when: what follows is standing.
                count = _keep_point(record, count, tick * dt_s, true)
                kept_t, kept_length = tick * dt_s, length
            memory[MEM_FORWARD] = memory[MEM_RIGHT] = memory[MEM_RATE] = 0.0
            if standing >= stand_ticks:
                break
            standing += 1
            if back_x != 0.0 or back_y != 0.0:
                sin_h, cos_h = math.sin(true[TRUE_HEADING]), math.cos(true[TRUE_HEADING])
                if standing * dt_s <= RECOIL_S:
                    memory[MEM_FORWARD] = back_x * sin_h + back_y * cos_h
                    memory[MEM_RIGHT] = back_x * cos_h - back_y * sin_h
        key = chain(base, tick)
        x0, y0, vx0, vy0, h0 = true[TRUE_X], true[TRUE_Y], true[TRUE_VX], true[TRUE_VY], true[TRUE_HEADING]
        _move(true, body, key, memory[MEM_FORWARD], memory[MEM_RIGHT], memory[MEM_RATE], dt_s)
        step = math.hypot(true[TRUE_X] - x0, true[TRUE_Y] - y0)
        if step > 0.0:
            # As long as less is travelled than was clear around the last point looked at, nothing can be near.
            near = free_m < step
            if near and body[BODY_COLLIDES] != 0.0:
                free_m = clearance(walls, discs, x0, y0) - body[BODY_RADIUS]
                near = free_m < step
            free_m -= step
            share, how, what = _first_contact(
                x0, y0, true[TRUE_X], true[TRUE_Y], body, walls, discs, codes, blocked, ground, bounds, near
            )
            if how != END_NONE:
                dx, dy = true[TRUE_X] - x0, true[TRUE_Y] - y0
                true[TRUE_X], true[TRUE_Y] = x0 + share * dx, y0 + share * dy
                true[TRUE_VX] = true[TRUE_VY] = true[TRUE_FORWARD] = true[TRUE_RIGHT] = 0.0
                true[TRUE_SWAY_X] = true[TRUE_SWAY_Y] = 0.0
                step *= share
                free_m = 0.0
                if end == END_NONE:
                    end, hit = how, what
                    stand_ticks = max(stand_ticks, math.ceil((RECOIL_S + 0.4) / dt_s))
                    back_x, back_y = -RECOIL_MPS * dx / math.hypot(dx, dy), -RECOIL_MPS * dy / math.hypot(dx, dy)
                    length += step
                    count = _keep_point(record, count, (tick + 1) * dt_s, true)
                    kept_t, kept_length, step = (tick + 1) * dt_s, length, 0.0
                else:
                    back_x = back_y = 0.0
        length += step
        rate, more = _sense(
            true,
            noise,
            key,
            tick,
            wrap_bearing(true[TRUE_HEADING] - h0),
            (true[TRUE_VX] - vx0) / dt_s,
            (true[TRUE_VY] - vy0) / dt_s,
            settings,
            state,
            cov,
            rejects,
            work,
            dt_s,
        )
        refused += more
        tick += 1
        error += (state[EKF_X] - true[TRUE_X]) ** 2 + (state[EKF_Y] - true[TRUE_Y]) ** 2
        if phase == PHASE_DRIVE:
            cross += _off_line(memory, true[TRUE_X], true[TRUE_Y]) ** 2
            driven += 1
        t_s = tick * dt_s
        moved = length - kept_length
        if (
            moved >= TRACK_M
            or (t_s - kept_t >= TRACK_S and moved >= TRACK_LEAST_M)
            or (
                t_s - kept_t >= TRACK_S
                and abs(wrap_bearing(true[TRUE_HEADING] - record[count - 1, 3])) >= TRACK_LEAST_RAD
            )
        ):
            count = _keep_point(record, count, t_s, true)
            kept_t, kept_length = t_s, length
    if tick * dt_s > record[count - 1, 0]:
        count = _keep_point(record, count, tick * dt_s, true)
    tally[TALLY_END], tally[TALLY_HIT], tally[TALLY_TICKS], tally[TALLY_LENGTH] = end, hit, tick, length
    tally[TALLY_CROSS_SQUARES], tally[TALLY_DRIVEN] = cross, driven
    tally[TALLY_ERROR_SQUARES], tally[TALLY_REFUSED] = error, refused
    return count
