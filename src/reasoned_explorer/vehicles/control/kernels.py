"""The arithmetic of control and localization, compiled: PID, waypoint follower, extended Kalman filter.

Functions take small float64 arrays whose slots are named by the constants below, so that the classes that wrap them
(`Pid`, `PidFollower`, `PoseFilter`) and the simulator's motion run the very same code. Units: metres, seconds, radians.
Headings are compass headings; "forward" is (sin h, cos h) and "right" is (cos h, -sin h) in east, north.

Numba keys its cache by a function's own file: after an edit here, callers that are cached elsewhere
(`simulation/kernels.py`) must be touched too.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]

TAU = 2.0 * math.pi

# --- PID gains ---------------------------------------------------------------------------------------------------
PID_KP, PID_KI, PID_KD, PID_LIMIT, PID_INTEGRAL_LIMIT = 0, 1, 2, 3, 4
PID_SIZE = 5

# --- follower: settings ------------------------------------------------------------------------------------------
(
    FOLLOW_CRUISE,
    FOLLOW_ACCELERATION,
    FOLLOW_BRAKING,
    FOLLOW_TURN_RATE,
    FOLLOW_TURN_ACCELERATION,
    FOLLOW_SIDEWAYS,
    FOLLOW_TURN_ABOVE,
    FOLLOW_TURN_BELOW,
    FOLLOW_LOOKAHEAD,
    FOLLOW_ARRIVAL,
    FOLLOW_FACING,
    FOLLOW_STUCK_S,
    FOLLOW_STUCK_M,
    FOLLOW_STUCK_RAD,
) = range(14)
FOLLOW_SIZE = 14

# --- follower: memory --------------------------------------------------------------------------------------------
(
    MEM_PHASE,
    MEM_INTEGRAL,
    MEM_FORWARD,
    MEM_RIGHT,
    MEM_RATE,
    MEM_START_X,
    MEM_START_Y,
    MEM_TARGET_X,
    MEM_TARGET_Y,
    MEM_TARGET_HEADING,
    MEM_BEST,
    MEM_SINCE_BEST,
    MEM_CROSS,
) = range(13)
MEM_SIZE = 13

# --- follower: phases --------------------------------------------------------------------------------------------
PHASE_TURN, PHASE_DRIVE, PHASE_BRAKE, PHASE_FACE, PHASE_ARRIVED, PHASE_STUCK = 0, 1, 2, 3, 4, 5

# --- filter: state -----------------------------------------------------------------------------------------------
(
    EKF_X,
    EKF_Y,
    EKF_VX,
    EKF_VY,
    EKF_HEADING,
    EKF_GYRO_BIAS,
    EKF_WANDER_X,
    EKF_WANDER_Y,
    EKF_COMPASS_WANDER,
) = range(9)
EKF_SIZE = 9

# --- filter: settings --------------------------------------------------------------------------------------------
(
    SET_GYRO_DENSITY,
    SET_ACCELERATION_DENSITY,
    SET_BIAS_WALK,
    SET_WANDER_SIGMA,
    SET_WANDER_TAU,
    SET_COMPASS_WANDER_SIGMA,
    SET_COMPASS_WANDER_TAU,
    SET_GATE_1,
    SET_GATE_2,
    SET_REJECTS,
) = range(10)
SET_SIZE = 10

# --- filter: counters of measurements refused in a row -----------------------------------------------------------
REJECT_POSITION, REJECT_VELOCITY, REJECT_ODOMETRY, REJECT_COMPASS = 0, 1, 2, 3
REJECT_SIZE = 4


@njit(cache=True, error_model="numpy")
def wrap_bearing(angle_rad: float) -> float:
    """Return an angle as a bearing in [-π, π)."""
    wrapped = (angle_rad + math.pi) % TAU - math.pi
    return -math.pi if wrapped >= math.pi else wrapped


@njit(cache=True, error_model="numpy")
def approach(value: float, goal: float, step: float) -> float:
    """Return the value moved towards the goal by at most a step."""
    return value + min(step, max(-step, goal - value))


@njit(cache=True, error_model="numpy")
def turned(forward: float, right: float, angle_rad: float) -> tuple[float, float]:
    """Return a fixed vector as a body sees it that has turned clockwise by an angle."""
    sin_a, cos_a = math.sin(angle_rad), math.cos(angle_rad)
    return forward * cos_a + right * sin_a, right * cos_a - forward * sin_a


# === PID =========================================================================================================


@njit(cache=True, error_model="numpy")
def pid_step(gains: Floats, integral: float, error: float, rate: float, dt_s: float) -> tuple[float, float]:
    """Return a PID controller's output and its new integral term.

    The derivative acts on the measurement (``rate`` is the measured quantity's own rate of change), so that a jump of
    the set point gives no kick. Anti-windup: while the output is saturated the integral only moves if that leads out
    of saturation, and it never exceeds its own limit.
    """
    limit = gains[PID_LIMIT]
    without = gains[PID_KP] * error - gains[PID_KD] * rate
    grown = integral + gains[PID_KI] * error * dt_s
    bound = gains[PID_INTEGRAL_LIMIT]
    grown = min(bound, max(-bound, grown))
    output = without + grown
    if (output > limit and grown > integral) or (output < -limit and grown < integral):
        grown = integral
        output = without + grown
    return min(limit, max(-limit, output)), grown


# === follower ====================================================================================================


@njit(cache=True, error_model="numpy")
def follower_start(
    memory: Floats, x_m: float, y_m: float, target_x_m: float, target_y_m: float, heading_rad: float, phase: int
) -> None:
    """Set a follower off from a position to a target; NaN as heading leaves the heading open."""
    memory[MEM_PHASE] = phase
    memory[MEM_INTEGRAL] = 0.0
    memory[MEM_START_X], memory[MEM_START_Y] = x_m, y_m
    memory[MEM_TARGET_X], memory[MEM_TARGET_Y] = target_x_m, target_y_m
    memory[MEM_TARGET_HEADING] = heading_rad
    memory[MEM_BEST], memory[MEM_SINCE_BEST] = math.inf, 0.0
    memory[MEM_CROSS] = 0.0


@njit(cache=True, error_model="numpy")
def _enter(memory: Floats, phase: int) -> None:
    memory[MEM_PHASE] = phase
    memory[MEM_INTEGRAL] = 0.0
    memory[MEM_BEST], memory[MEM_SINCE_BEST] = math.inf, 0.0


@njit(cache=True, error_model="numpy")
def _watch(memory: Floats, remaining: float, least: float, patience_s: float, dt_s: float) -> None:
    """Note progress: ``remaining`` must fall by ``least`` within the patience, else the follower is stuck."""
    if remaining <= memory[MEM_BEST] - least:
        memory[MEM_BEST], memory[MEM_SINCE_BEST] = remaining, 0.0
        return
    memory[MEM_SINCE_BEST] += dt_s
    if memory[MEM_SINCE_BEST] > patience_s:
        memory[MEM_PHASE] = PHASE_STUCK


@njit(cache=True, error_model="numpy")
def _turn_command(
    settings: Floats, gains: Floats, memory: Floats, error_rad: float, rate_radps: float, dt_s: float
) -> None:
    """Move the commanded yaw rate towards what the heading PID wants, braking in time and within the limits."""
    wanted, memory[MEM_INTEGRAL] = pid_step(gains, memory[MEM_INTEGRAL], error_rad, rate_radps, dt_s)
    # No faster than what can be braked before the heading is reached (at 60 % of what the machine can do).
    most = math.sqrt(1.2 * settings[FOLLOW_TURN_ACCELERATION] * abs(error_rad)) + 0.02
    wanted = min(most, max(-most, wanted))
    memory[MEM_RATE] = approach(memory[MEM_RATE], wanted, settings[FOLLOW_TURN_ACCELERATION] * dt_s)


@njit(cache=True, error_model="numpy")
def _speed_command(settings: Floats, memory: Floats, forward_mps: float, right_mps: float, dt_s: float) -> None:
    """Move the commanded velocity (body frame) towards what is wanted, within the acceleration limit."""
    gap_forward, gap_right = forward_mps - memory[MEM_FORWARD], right_mps - memory[MEM_RIGHT]
    gap = math.hypot(gap_forward, gap_right)
    step = settings[FOLLOW_ACCELERATION] * dt_s
    if gap <= step:
        memory[MEM_FORWARD], memory[MEM_RIGHT] = forward_mps, right_mps
    else:
        memory[MEM_FORWARD] += gap_forward * step / gap
        memory[MEM_RIGHT] += gap_right * step / gap


@njit(cache=True, error_model="numpy")
def _drive(
    settings: Floats,
    gains: Floats,
    memory: Floats,
    x_m: float,
    y_m: float,
    heading_rad: float,
    rate_radps: float,
    dt_s: float,
) -> None:
    line_x, line_y = memory[MEM_TARGET_X] - memory[MEM_START_X], memory[MEM_TARGET_Y] - memory[MEM_START_Y]
    length = math.hypot(line_x, line_y)
    to_x, to_y = memory[MEM_TARGET_X] - x_m, memory[MEM_TARGET_Y] - y_m
    distance = math.hypot(to_x, to_y)
    if length > 0.0:
        line_x, line_y = line_x / length, line_y / length
    along = to_x * line_x + to_y * line_y
    memory[MEM_CROSS] = to_y * line_x - to_x * line_y
    # Arrived: near enough, or past the perpendicular through the target (a wandering estimate may never come near).
    if distance <= settings[FOLLOW_ARRIVAL] or along <= 0.0:
        _enter(memory, PHASE_BRAKE)
        return
    # Aim at a point of the line ahead of the own projection on it, at most at the target itself.
    beyond = max(0.0, along - settings[FOLLOW_LOOKAHEAD])
    aim_x, aim_y = to_x - line_x * beyond, to_y - line_y * beyond
    course = math.atan2(aim_x, aim_y)
    speed = min(settings[FOLLOW_CRUISE], math.sqrt(2.0 * settings[FOLLOW_BRAKING] * distance))
    off_course = wrap_bearing(course - heading_rad)
    if settings[FOLLOW_SIDEWAYS] > 0.0:
        # Any direction can be moved in: the body turns to its final heading meanwhile.
        final = memory[MEM_TARGET_HEADING]
        error = off_course if math.isnan(final) else wrap_bearing(final - heading_rad)
        _turn_command(settings, gains, memory, error, rate_radps, dt_s)
        # The body turned under the velocity that it was told: over ground that velocity is still the same.
        memory[MEM_FORWARD], memory[MEM_RIGHT] = turned(memory[MEM_FORWARD], memory[MEM_RIGHT], rate_radps * dt_s)
        _speed_command(settings, memory, speed * math.cos(off_course), speed * math.sin(off_course), dt_s)
    else:
        if abs(off_course) > settings[FOLLOW_TURN_ABOVE]:
            _enter(memory, PHASE_TURN)
            return
        _turn_command(settings, gains, memory, off_course, rate_radps, dt_s)
        _speed_command(settings, memory, speed * max(0.2, math.cos(off_course)), 0.0, dt_s)
    _watch(memory, distance, settings[FOLLOW_STUCK_M], settings[FOLLOW_STUCK_S], dt_s)


@njit(cache=True, error_model="numpy")
def follower_step(
    settings: Floats,
    gains: Floats,
    memory: Floats,
    x_m: float,
    y_m: float,
    heading_rad: float,
    rate_radps: float,
    dt_s: float,
) -> int:
    """Take the next step of a leg and return the phase.

    Reads the estimated position, heading and yaw rate; leaves the command in ``memory``: MEM_FORWARD and MEM_RIGHT
    (metres a second, body frame) and MEM_RATE (radians a second, clockwise).
    """
    phase = int(memory[MEM_PHASE])
    if phase == PHASE_DRIVE:
        _drive(settings, gains, memory, x_m, y_m, heading_rad, rate_radps, dt_s)
        phase = int(memory[MEM_PHASE])
    if phase == PHASE_TURN:
        course = math.atan2(memory[MEM_TARGET_X] - x_m, memory[MEM_TARGET_Y] - y_m)
        error = wrap_bearing(course - heading_rad)
        _turn_command(settings, gains, memory, error, rate_radps, dt_s)
        _speed_command(settings, memory, 0.0, 0.0, dt_s)
        if abs(error) < settings[FOLLOW_TURN_BELOW]:
            _enter(memory, PHASE_DRIVE)
        else:
            _watch(memory, abs(error), settings[FOLLOW_STUCK_RAD], settings[FOLLOW_STUCK_S], dt_s)
    elif phase in (PHASE_BRAKE, PHASE_FACE):
        final = memory[MEM_TARGET_HEADING]
        error = 0.0 if math.isnan(final) else wrap_bearing(final - heading_rad)
        _turn_command(settings, gains, memory, error, rate_radps, dt_s)
        if settings[FOLLOW_SIDEWAYS] > 0.0:
            memory[MEM_FORWARD], memory[MEM_RIGHT] = turned(memory[MEM_FORWARD], memory[MEM_RIGHT], rate_radps * dt_s)
        _speed_command(settings, memory, 0.0, 0.0, dt_s)
        stopped = memory[MEM_FORWARD] == 0.0 and memory[MEM_RIGHT] == 0.0
        if phase == PHASE_BRAKE:
            if stopped:
                _enter(memory, PHASE_FACE)
        elif abs(error) < settings[FOLLOW_FACING] and abs(memory[MEM_RATE]) < 0.1:
            memory[MEM_RATE] = 0.0
            _enter(memory, PHASE_ARRIVED)
        else:
            _watch(memory, abs(error), settings[FOLLOW_STUCK_RAD], settings[FOLLOW_STUCK_S], dt_s)
    return int(memory[MEM_PHASE])


# === localization filter =========================================================================================


@njit(cache=True, error_model="numpy")
def filter_predict(
    settings: Floats,
    state: Floats,
    cov: Floats,
    dt_s: float,
    gyro_radps: float,
    forward_mps2: float,
    right_mps2: float,
) -> None:
    """Carry the filter over a time step by the IMU's mean yaw rate and horizontal acceleration (body frame)."""
    turn = (gyro_radps - state[EKF_GYRO_BIAS]) * dt_s
    middle = state[EKF_HEADING] + 0.5 * turn
    sin_h, cos_h = math.sin(middle), math.cos(middle)
    east = forward_mps2 * sin_h + right_mps2 * cos_h
    north = forward_mps2 * cos_h - right_mps2 * sin_h
    state[EKF_X] += (state[EKF_VX] + 0.5 * east * dt_s) * dt_s
    state[EKF_Y] += (state[EKF_VY] + 0.5 * north * dt_s) * dt_s
    state[EKF_VX] += east * dt_s
    state[EKF_VY] += north * dt_s
    state[EKF_HEADING] = wrap_bearing(state[EKF_HEADING] + turn)
    keep = math.exp(-dt_s / settings[SET_WANDER_TAU])
    keep_compass = math.exp(-dt_s / settings[SET_COMPASS_WANDER_TAU])
    state[EKF_WANDER_X] *= keep
    state[EKF_WANDER_Y] *= keep
    state[EKF_COMPASS_WANDER] *= keep_compass
    # F P Fᵀ with the few entries of F that are not those of the identity: rows first, then columns. The velocity turns
    # with the heading: d(east)/dh = north, d(north)/dh = -east.
    d_vx, d_vy = north * dt_s, -east * dt_s
    for k in range(EKF_SIZE):
        cov[EKF_X, k] += dt_s * cov[EKF_VX, k]
        cov[EKF_Y, k] += dt_s * cov[EKF_VY, k]
        cov[EKF_VX, k] += d_vx * cov[EKF_HEADING, k]
        cov[EKF_VY, k] += d_vy * cov[EKF_HEADING, k]
        cov[EKF_HEADING, k] -= dt_s * cov[EKF_GYRO_BIAS, k]
        cov[EKF_WANDER_X, k] *= keep
        cov[EKF_WANDER_Y, k] *= keep
        cov[EKF_COMPASS_WANDER, k] *= keep_compass
    for k in range(EKF_SIZE):
        cov[k, EKF_X] += dt_s * cov[k, EKF_VX]
        cov[k, EKF_Y] += dt_s * cov[k, EKF_VY]
        cov[k, EKF_VX] += d_vx * cov[k, EKF_HEADING]
        cov[k, EKF_VY] += d_vy * cov[k, EKF_HEADING]
        cov[k, EKF_HEADING] -= dt_s * cov[k, EKF_GYRO_BIAS]
        cov[k, EKF_WANDER_X] *= keep
        cov[k, EKF_WANDER_Y] *= keep
        cov[k, EKF_COMPASS_WANDER] *= keep_compass
    shake = settings[SET_ACCELERATION_DENSITY] ** 2
    for axis in range(2):
        place, speed = EKF_X + axis, EKF_VX + axis
        cov[place, place] += shake * dt_s**3 / 3.0
        cov[place, speed] += shake * dt_s**2 / 2.0
        cov[speed, place] += shake * dt_s**2 / 2.0
        cov[speed, speed] += shake * dt_s
    cov[EKF_HEADING, EKF_HEADING] += settings[SET_GYRO_DENSITY] ** 2 * dt_s
    cov[EKF_GYRO_BIAS, EKF_GYRO_BIAS] += settings[SET_BIAS_WALK] ** 2 * dt_s
    fresh = settings[SET_WANDER_SIGMA] ** 2 * (1.0 - keep * keep)
    cov[EKF_WANDER_X, EKF_WANDER_X] += fresh
    cov[EKF_WANDER_Y, EKF_WANDER_Y] += fresh
    cov[EKF_COMPASS_WANDER, EKF_COMPASS_WANDER] += settings[SET_COMPASS_WANDER_SIGMA] ** 2 * (
        1.0 - keep_compass * keep_compass
    )


@njit(cache=True, error_model="numpy")
def filter_stand(settings: Floats, state: Floats, cov: Floats, dt_s: float) -> None:
    """Carry the filter over a time in which the vehicle is known to stand still, in one go.

    Position and heading stay; the velocity is zero; the slow errors of receiver, compass and gyro go their way.
    """
    keep = math.exp(-dt_s / settings[SET_WANDER_TAU])
    keep_compass = math.exp(-dt_s / settings[SET_COMPASS_WANDER_TAU])
    for k in range(EKF_SIZE):
        cov[EKF_VX, k] = cov[k, EKF_VX] = 0.0
        cov[EKF_VY, k] = cov[k, EKF_VY] = 0.0
    for k in range(EKF_SIZE):
        cov[EKF_WANDER_X, k] *= keep
        cov[EKF_WANDER_Y, k] *= keep
        cov[EKF_COMPASS_WANDER, k] *= keep_compass
    for k in range(EKF_SIZE):
        cov[k, EKF_WANDER_X] *= keep
        cov[k, EKF_WANDER_Y] *= keep
        cov[k, EKF_COMPASS_WANDER] *= keep_compass
    state[EKF_VX] = state[EKF_VY] = 0.0
    state[EKF_WANDER_X] *= keep
    state[EKF_WANDER_Y] *= keep
    state[EKF_COMPASS_WANDER] *= keep_compass
    cov[EKF_VX, EKF_VX] = cov[EKF_VY, EKF_VY] = 1e-6
    cov[EKF_GYRO_BIAS, EKF_GYRO_BIAS] += settings[SET_BIAS_WALK] ** 2 * dt_s
    fresh = settings[SET_WANDER_SIGMA] ** 2 * (1.0 - keep * keep)
    cov[EKF_WANDER_X, EKF_WANDER_X] += fresh
    cov[EKF_WANDER_Y, EKF_WANDER_Y] += fresh
    cov[EKF_COMPASS_WANDER, EKF_COMPASS_WANDER] += settings[SET_COMPASS_WANDER_SIGMA] ** 2 * (
        1.0 - keep_compass * keep_compass
    )


@njit(cache=True, error_model="numpy")
def _fuse(
    state: Floats,
    cov: Floats,
    work: Floats,
    residual: float,
    variance: float,
    first: int,
    first_h: float,
    second: int,
    second_h: float,
    third: int,
    third_h: float,
) -> None:
    """Fuse a scalar measurement whose Jacobian has three entries (the same index may appear with 0)."""
    for k in range(EKF_SIZE):
        work[k] = cov[k, first] * first_h + cov[k, second] * second_h + cov[k, third] * third_h
    inverse = 1.0 / (work[first] * first_h + work[second] * second_h + work[third] * third_h + variance)
    for k in range(EKF_SIZE):
        gain = work[k] * inverse
        state[k] += gain * residual
        for m in range(EKF_SIZE):
            cov[k, m] -= gain * work[m]
    state[EKF_HEADING] = wrap_bearing(state[EKF_HEADING])


@njit(cache=True, error_model="numpy")
def _gate_pair(
    cov: Floats, a: int, a_slow: int, b: int, b_slow: int, res_a: float, res_b: float, variance: float
) -> float:
    """Return the squared Mahalanobis distance of a pair of residuals; a slow index of -1 means there is none."""
    s_aa, s_bb, s_ab = cov[a, a] + variance, cov[b, b] + variance, cov[a, b]
    if a_slow >= 0:
        s_aa += 2.0 * cov[a, a_slow] + cov[a_slow, a_slow]
        s_bb += 2.0 * cov[b, b_slow] + cov[b_slow, b_slow]
        s_ab += cov[a, b_slow] + cov[a_slow, b] + cov[a_slow, b_slow]
    determinant = s_aa * s_bb - s_ab * s_ab
    squared: float = (res_a * res_a * s_bb - 2.0 * res_a * res_b * s_ab + res_b * res_b * s_aa) / determinant
    return squared


@njit(cache=True, error_model="numpy")
def _loosen(cov: Floats, index: int, variance: float) -> None:
    """Forget what was known of one entry of the state: its variance becomes this, its correlations zero."""
    for k in range(EKF_SIZE):
        cov[index, k] = cov[k, index] = 0.0
    cov[index, index] = variance


@njit(cache=True, error_model="numpy")
def filter_position(
    settings: Floats,
    state: Floats,
    cov: Floats,
    rejects: NDArray[np.int64],
    work: Floats,
    x_m: float,
    y_m: float,
    sigma_m: float,
) -> bool:
    """Fuse a satellite fix (white error sigma per axis) and return whether it passed the gate.

    So many refusals in a row that the filter itself must be wrong make it start over from the fix.
    """
    variance = sigma_m * sigma_m
    res_x = x_m - state[EKF_X] - state[EKF_WANDER_X]
    res_y = y_m - state[EKF_Y] - state[EKF_WANDER_Y]
    if _gate_pair(cov, EKF_X, EKF_WANDER_X, EKF_Y, EKF_WANDER_Y, res_x, res_y, variance) > settings[SET_GATE_2]:
        rejects[REJECT_POSITION] += 1
        if rejects[REJECT_POSITION] < settings[SET_REJECTS]:
            return False
        _loosen(cov, EKF_X, res_x * res_x + variance)
        _loosen(cov, EKF_Y, res_y * res_y + variance)
    rejects[REJECT_POSITION] = 0
    _fuse(state, cov, work, res_x, variance, EKF_X, 1.0, EKF_WANDER_X, 1.0, EKF_X, 0.0)
    res_y = y_m - state[EKF_Y] - state[EKF_WANDER_Y]
    _fuse(state, cov, work, res_y, variance, EKF_Y, 1.0, EKF_WANDER_Y, 1.0, EKF_Y, 0.0)
    return True


@njit(cache=True, error_model="numpy")
def filter_velocity(
    settings: Floats,
    state: Floats,
    cov: Floats,
    rejects: NDArray[np.int64],
    work: Floats,
    vx_mps: float,
    vy_mps: float,
    sigma_mps: float,
) -> bool:
    """Fuse a satellite receiver's Doppler velocity (east, north) and return whether it passed the gate.

    With the odometry this is what tells the heading of a moving vehicle (its course); at rest it tells nothing of it.
    """
    variance = sigma_mps * sigma_mps
    res_x, res_y = vx_mps - state[EKF_VX], vy_mps - state[EKF_VY]
    if _gate_pair(cov, EKF_VX, -1, EKF_VY, -1, res_x, res_y, variance) > settings[SET_GATE_2]:
        rejects[REJECT_VELOCITY] += 1
        if rejects[REJECT_VELOCITY] < settings[SET_REJECTS]:
            return False
        _loosen(cov, EKF_VX, res_x * res_x + variance)
        _loosen(cov, EKF_VY, res_y * res_y + variance)
    rejects[REJECT_VELOCITY] = 0
    _fuse(state, cov, work, res_x, variance, EKF_VX, 1.0, EKF_VX, 0.0, EKF_VX, 0.0)
    res_y = vy_mps - state[EKF_VY]
    _fuse(state, cov, work, res_y, variance, EKF_VY, 1.0, EKF_VY, 0.0, EKF_VY, 0.0)
    return True


@njit(cache=True, error_model="numpy")
def filter_odometry(
    settings: Floats,
    state: Floats,
    cov: Floats,
    rejects: NDArray[np.int64],
    work: Floats,
    forward_mps: float,
    right_mps: float,
    sigma_mps: float,
) -> bool:
    """Fuse a body-frame velocity (wheels, legs or optical flow) and return whether it passed the gate."""
    variance = sigma_mps * sigma_mps
    sin_h, cos_h = math.sin(state[EKF_HEADING]), math.cos(state[EKF_HEADING])
    ahead = state[EKF_VX] * sin_h + state[EKF_VY] * cos_h
    aside = state[EKF_VX] * cos_h - state[EKF_VY] * sin_h
    res_forward, res_right = forward_mps - ahead, right_mps - aside
    # The gate takes the velocity's own uncertainty (no turn changes it) and leaves the heading's small part out.
    spread = 0.5 * (cov[EKF_VX, EKF_VX] + cov[EKF_VY, EKF_VY]) + variance
    spread += cov[EKF_HEADING, EKF_HEADING] * (ahead * ahead + aside * aside)
    if (res_forward * res_forward + res_right * res_right) / spread > settings[SET_GATE_2]:
        rejects[REJECT_ODOMETRY] += 1
        if rejects[REJECT_ODOMETRY] < settings[SET_REJECTS]:
            return False
        _loosen(cov, EKF_VX, spread + res_forward * res_forward + res_right * res_right)
        _loosen(cov, EKF_VY, spread + res_forward * res_forward + res_right * res_right)
    rejects[REJECT_ODOMETRY] = 0
    _fuse(state, cov, work, res_forward, variance, EKF_VX, sin_h, EKF_VY, cos_h, EKF_HEADING, aside)
    sin_h, cos_h = math.sin(state[EKF_HEADING]), math.cos(state[EKF_HEADING])
    ahead = state[EKF_VX] * sin_h + state[EKF_VY] * cos_h
    aside = state[EKF_VX] * cos_h - state[EKF_VY] * sin_h
    _fuse(state, cov, work, right_mps - aside, variance, EKF_VX, cos_h, EKF_VY, -sin_h, EKF_HEADING, -ahead)
    return True


@njit(cache=True, error_model="numpy")
def filter_compass(
    settings: Floats,
    state: Floats,
    cov: Floats,
    rejects: NDArray[np.int64],
    work: Floats,
    heading_rad: float,
    sigma_rad: float,
) -> bool:
    """Fuse a compass heading and return whether it passed the gate."""
    variance = sigma_rad * sigma_rad
    residual = wrap_bearing(heading_rad - state[EKF_HEADING] - state[EKF_COMPASS_WANDER])
    spread = cov[EKF_HEADING, EKF_HEADING] + 2.0 * cov[EKF_HEADING, EKF_COMPASS_WANDER] + variance
    spread += cov[EKF_COMPASS_WANDER, EKF_COMPASS_WANDER]
    if residual * residual / spread > settings[SET_GATE_1]:
        rejects[REJECT_COMPASS] += 1
        if rejects[REJECT_COMPASS] < settings[SET_REJECTS]:
            return False
        _loosen(cov, EKF_HEADING, residual * residual + variance)
    rejects[REJECT_COMPASS] = 0
    _fuse(state, cov, work, residual, variance, EKF_HEADING, 1.0, EKF_COMPASS_WANDER, 1.0, EKF_HEADING, 0.0)
    return True
