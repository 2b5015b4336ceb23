"""Our planar swimmer beside MuJoCo's and Pinocchio's, in the same run.

    python compare.py PROGRAM [--quick] [--json FILE]

PROGRAM is `target/release/examples/peer` of froude-swim. First what both compute is compared: rigid accelerations, and the path of a
chain with servos and this drag (inside MuJoCo by mjcb_passive, without added mass, which MuJoCo lacks). Then times: per step, and
per simulated second at an error of the speed of 1e-3 on both sides. Exits with 1 when a bar is missed; --quick leaves the times out.

MuJoCo's own fluid is its ellipsoid model, which costs it as little as any; its servo targets are
held over a step, at their value in its middle, which is of second order.
"""
import argparse
import json
import os
import subprocess
import time

import mujoco
import numpy as np
import pinocchio as pin
from mujoco import rollout

# Of the snake robot Mamba: half-length m, mass kg, inertia kg m2, added mass across kg; drag of f2 by the circulation tank.
L, M, J, SWAY = 0.09, 1.343, 1.343 * (0.09**2 / 3 + 0.0394**2 / 4), 1.653
PI_AREA = 0.5 * 1025 * np.pi * 0.5 * (0.0588 + 0.0394) * 2 * L
FRONT = 0.5 * 1025 * 2 * 0.0588 * 2 * L
ALONG, ACROSS = (0.0, 0.0544 * PI_AREA), (0.0603 * FRONT, 1.8601 * FRONT)
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(4)
# Largest differences: of accelerations relative to the largest, of the centre of mass in m.
RIGID, PATH = 1e-9, 1e-9
# Ratio to MuJoCo's RK4 per step, to its RK4 and to its semi-implicit Euler at an error of the speed of 1e-3, to Pinocchio per evaluation.
BARS = {"step": 10, "rk4": 10, "euler": 3, "forward": 8}


def ours(program, mode, numbers):
    out = subprocess.run([program, mode], input=np.asarray(numbers, float).tobytes(), capture_output=True, check=True).stdout
    return json.loads(out) if out[:1] == b"{" else np.frombuffer(out)


# ------------------------------------------------------------------------------------------------ models of the peers
def mjcf(n, integrator, step, own_fluid, kp=0.0, kd=0.0, viscous=0.0):
    """Links from head to tail, each body's origin at the joint before it; the head's at its centre."""
    fluid = 'density="1025" viscosity="0.001"' if own_fluid else ""
    body, close = "", ""
    for i in range(n):
        at = "0 0 0" if i == 0 else (f"{-L} 0 0" if i == 1 else f"{-2 * L} 0 0")
        centre = "0 0 0" if i == 0 else f"{-L} 0 0"
        joint = ('<joint name="x" type="slide" axis="1 0 0"/><joint name="y" type="slide" axis="0 1 0"/><joint name="th" axis="0 0 1"/>'
                 if i == 0 else f'<joint name="j{i}" axis="0 0 1" damping="{viscous}"/>')
        geom = (f'<geom type="ellipsoid" pos="{centre}" size="{L} 0.0394 0.0588" mass="0" fluidshape="ellipsoid"/>' if own_fluid else "")
        body += f'<body pos="{at}"><inertial pos="{centre}" mass="{M}" diaginertia="{J} {J} {J}"/>{joint}{geom}'
        close += "</body>"
    act = "".join(f'<position joint="j{i}" kp="{kp}" kv="{kd}"/>' for i in range(1, n)) if kp else ""
    return f"""<mujoco><compiler angle="radian"/>
<option timestep="{step}" integrator="{integrator}" gravity="0 0 0" {fluid}><flag contact="disable"/></option>
<worldbody>{body}{close}</worldbody><actuator>{act}</actuator></mujoco>"""


def pin_model(n):
    m = pin.Model()
    m.gravity = pin.Motion.Zero()
    parent, at = 0, pin.SE3.Identity()
    for joint, name in ((pin.JointModelPX(), "x"), (pin.JointModelPY(), "y"), (pin.JointModelRZ(), "th")):
        parent = m.addJoint(parent, joint, at, name)
    m.appendBodyToJoint(parent, pin.Inertia(M, np.zeros(3), np.eye(3) * J), at)
    for i in range(1, n):
        at = pin.SE3(np.eye(3), np.array([-L if i == 1 else -2 * L, 0, 0]))
        parent = m.addJoint(parent, pin.JointModelRZ(), at, f"j{i}")
        m.appendBodyToJoint(parent, pin.Inertia(M, np.array([-L, 0, 0]), np.eye(3) * J), pin.SE3.Identity())
    return m


# ------------------------------------------------------------------------------------------------ what both compute
def rigid(program):
    """Largest difference of accelerations at random states, of each peer."""
    rng, worst = np.random.default_rng(3), {"mujoco": 0.0, "pinocchio": 0.0}
    for n in (2, 3, 5, 10, 20, 50):
        states, theirs = [], {"mujoco": [], "pinocchio": []}
        model = mujoco.MjModel.from_xml_string(mjcf(n, "RK4", 1e-3, False))
        data, pmodel = mujoco.MjData(model), pin_model(n)
        pdata = pmodel.createData()
        heads = []
        for _ in range(20):
            q = np.concatenate([rng.normal(size=3), 0.4 * rng.normal(size=n - 1)])
            v, torque = rng.normal(size=n + 2), rng.normal(size=n - 1)
            c, s = np.cos(q[2]), np.sin(q[2])
            # phi is the heading of the link before less that of the link, so that hinges turn the other way.
            states.append(np.concatenate([[v[2], c * v[0] + s * v[1], c * v[1] - s * v[0]], -q[3:], -v[3:], torque]))
            heads.append((c, s, v))
            data.qpos[:], data.qvel[:] = q, v
            data.qfrc_applied[:] = np.concatenate([np.zeros(3), -torque])
            mujoco.mj_forward(model, data)
            theirs["mujoco"].append(data.qacc.copy())
            theirs["pinocchio"].append(pin.aba(pmodel, pdata, q, v, np.concatenate([np.zeros(3), -torque])).copy())
        found = ours(program, "accelerations", np.concatenate([[n, M, J, L], *states])).reshape(20, n + 2)
        for (c, s, v), state, row, k in zip(heads, states, found, range(20)):
            w, u, sway = state[:3]
            along, across = row[1] - w * sway, row[2] + w * u
            mine = np.concatenate([[c * along - s * across, s * along + c * across, row[0]], -row[3:]])
            for peer in worst:
                a = theirs[peer][k]
                worst[peer] = max(worst[peer], np.abs(mine - a).max() / np.abs(a).max())
    return worst


PROBLEM = dict(n=10, kp=20.0, kd=1.0, viscous=0.0, amplitude=np.radians(30), frequency=np.radians(80), phase=np.radians(40))


def numbers(p, sway, h, steps):
    return [p["n"], M, J, L, sway, *ALONG, *ACROSS, p["kp"], p["kd"], p["viscous"], p["amplitude"], p["frequency"], p["phase"], h, steps]


def drag_and_servos(model, data):
    """qfrc_passive of our drag by strips and of the servos, at the stage's own time."""
    n, p = model.nv - 2, PROBLEM
    q, v = data.qpos, data.qvel
    heading, rate = np.cumsum(q[2:]), np.cumsum(v[2:])
    c, s = np.cos(heading), np.sin(heading)
    # Centres and their velocities, from the head's.
    back = np.concatenate([[0], np.cumsum(L * (c[:-1] + c[1:]))]), np.concatenate([[0], np.cumsum(L * (s[:-1] + s[1:]))])
    slip = (np.concatenate([[0], np.cumsum(L * (rate[:-1] * s[:-1] + rate[1:] * s[1:]))]),
            np.concatenate([[0], np.cumsum(L * (rate[:-1] * c[:-1] + rate[1:] * c[1:]))]))
    x, y, vx, vy = -back[0], -back[1], v[0] + slip[0], v[1] - slip[1]
    u, w = c * vx + s * vy, c * vy - s * vx
    speed = w[:, None] + L * POINTS * rate[:, None]
    strip = 0.5 * WEIGHTS * (ACROSS[0] + ACROSS[1] * np.abs(speed)) * speed
    f_along, f_across = -(ALONG[0] + ALONG[1] * np.abs(u)) * u, -strip.sum(1)
    moment = -(L * POINTS * strip).sum(1)
    fx, fy = c * f_along - s * f_across, s * f_along + c * f_across
    data.qfrc_passive[0], data.qfrc_passive[1] = fx.sum(), fy.sum()
    # Hinge k turns all links from k on about its place.
    joint_x = np.concatenate([[0.0], x[1:] + L * c[1:]])
    joint_y = np.concatenate([[0.0], y[1:] + L * s[1:]])
    tail = lambda a: np.cumsum(a[::-1])[::-1]
    data.qfrc_passive[2:] = tail(moment) + tail(x * fy - y * fx) - joint_x * tail(fy) + joint_y * tail(fx)
    i = np.arange(n - 1)
    wave = p["frequency"] * data.time - i * p["phase"]
    wanted, wanted_rate = p["amplitude"] * np.sin(wave), p["amplitude"] * p["frequency"] * np.cos(wave)
    data.qfrc_passive[3:] -= p["kp"] * (wanted + q[3:]) + p["kd"] * (wanted_rate + v[3:])


def path(program, seconds=9.0, h=2.5e-4, every=400):
    """Largest distance of the centres of mass over the time, m.

    Both sides are RK4 of the same step, ours in the head's axes and MuJoCo's in the tank's: what lies between them is h^4 of either, 2e-8 m at 1 ms.
    """
    steps = round(seconds / h)
    mine = ours(program, "path", numbers(PROBLEM, 0.0, h, steps) + [every]).reshape(-1, 2)
    model = mujoco.MjModel.from_xml_string(mjcf(PROBLEM["n"], "RK4", h, False))
    data = mujoco.MjData(model)
    mujoco.set_mjcb_passive(drag_and_servos)
    theirs = []
    try:
        for i in range(steps + 1):
            if i % every == 0:
                mujoco.mj_kinematics(model, data)
                mujoco.mj_comPos(model, data)
                theirs.append(data.subtree_com[0][:2].copy())
            if i < steps:
                mujoco.mj_step(model, data)
    finally:
        mujoco.set_mjcb_passive(None)
    theirs = np.array(theirs)
    way = np.hypot(*(theirs[-1] - theirs[0]))
    return np.hypot(*(mine - theirs).T).max(), way


# ------------------------------------------------------------------------------------------------ times
def timed_mujoco(p, integrator, h, seconds, rounds=3):
    """Least seconds of a rollout in C, and the speed of its head."""
    n, steps = p["n"], round(seconds / h)
    model = mujoco.MjModel.from_xml_string(mjcf(n, integrator, h, True, p["kp"], p["kd"], p["viscous"]))
    data = mujoco.MjData(model)
    start = np.zeros(mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS))
    mujoco.mj_getState(model, data, start, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    time_s = ((np.arange(steps) + 0.5) * h)[:, None]
    control = -p["amplitude"] * np.sin(p["frequency"] * time_s - np.arange(n - 1)[None, :] * p["phase"])
    least = np.inf
    for _ in range(rounds):
        begin = time.perf_counter()
        states, _ = rollout.rollout(model, data, start[None], control[None])
        least = min(least, time.perf_counter() - begin)
    end = states[0, -1, 1:3]
    return least, float(np.hypot(*end) / seconds) if np.isfinite(end).all() else np.inf


def timed_ours(program, p, h, seconds):
    found = ours(program, "time", numbers(p, SWAY, h, round(seconds / h)))
    return found["us_per_step"] * 1e-6 * round(seconds / h), found["speed_m_s"]


def longest(run, steps_ms, reference):
    """The longest step whose speed is within 1e-3 of the reference, as are all shorter ones, with its time."""
    best = None
    for h in sorted(steps_ms):
        seconds, speed = run(h * 1e-3)
        if abs(speed / reference - 1) > 1e-3:
            break
        best = (h, seconds, speed)
    return best


def forward(n):
    """Least microseconds of Pinocchio's forward dynamics from Python, its call included (0.4 us of 19)."""
    model = pin_model(n)
    data = model.createData()
    rng = np.random.default_rng(1)
    q, v, torque = (0.3 * rng.normal(size=model.nv) for _ in range(3))
    least = np.inf
    for _ in range(5):
        begin = time.perf_counter()
        for _ in range(5000):
            pin.aba(model, data, q, v, torque)
        least = min(least, (time.perf_counter() - begin) / 5000)
    return 1e6 * least


def times(program, rows):
    missed = []

    def judge(name, ratio, bar):
        rows.append(dict(case=name, ratio=ratio, bar=bar))
        if bar and ratio < bar:
            missed.append(name)

    for n in (5, 10, 20, 50):
        p = dict(PROBLEM, n=n, kp=2.0, kd=0.1, viscous=0.02, amplitude=min(0.5, 3.0 / n), frequency=2 * np.pi, phase=2 * np.pi / n)
        theirs = {i: timed_mujoco(p, i, 1e-3, 10.0)[0] / 1e4 * 1e6 for i in ("RK4", "Euler")}
        mine = timed_ours(program, p, 1e-3, 10.0)[0] / 1e4 * 1e6
        print(f"n = {n:2}: a step {mine:.2f} us; MuJoCo RK4 {theirs['RK4']:.2f} us ({theirs['RK4'] / mine:.1f}x), "
              f"Euler {theirs['Euler']:.2f} us ({theirs['Euler'] / mine:.1f}x)")
        judge(f"step, n = {n}", theirs["RK4"] / mine, BARS["step"])
        best = {"ours": longest(lambda h: timed_ours(program, p, h, 10.0), (0.5, 1, 2, 2.5, 4, 5, 6.25, 8, 10, 12.5, 16, 20),
                                timed_ours(program, p, 1e-4, 10.0)[1])}
        for integrator in ("RK4", "Euler"):
            reference = timed_mujoco(p, integrator, 5e-5, 10.0, rounds=1)[1]
            best[integrator] = longest(lambda h: timed_mujoco(p, integrator, h, 10.0), (0.1, 0.2, 0.25, 0.5, 1, 2, 2.5, 4, 5, 6.25, 8, 10), reference)
        said = ", ".join(f"{k} {b[0]:g} ms {1e5 * b[1]:.2f} us a simulated ms" if b else f"{k} reaches it at none" for k, b in best.items())
        print(f"        at an error of the speed of 1e-3: {said.replace(' us a simulated ms', ' ms a simulated 100 s')}")
        for integrator, bar in (("RK4", "rk4"), ("Euler", "euler")):
            if best[integrator] and best["ours"]:
                judge(f"equal error, n = {n}, MuJoCo {integrator}", best[integrator][1] / best["ours"][1], BARS[bar])
    theirs, mine = forward(50), ours(program, "forward", [50])["us"]
    print(f"forward dynamics, n = 50: {mine:.2f} us, Pinocchio {theirs:.2f} us ({theirs / mine:.1f}x)")
    judge("forward dynamics, n = 50", theirs / mine, BARS["forward"])
    return missed


def main():
    ap = argparse.ArgumentParser()
    ap.add_argument("program")
    ap.add_argument("--quick", action="store_true")
    ap.add_argument("--json")
    args = ap.parse_args()
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    missed, rows = [], []
    for peer, apart in rigid(args.program).items():
        print(f"rigid accelerations against {peer}, n = 2 to 50: apart by {apart:.1e} of the largest (bar {RIGID:.0e})")
        rows.append(dict(case=f"rigid accelerations, {peer}", apart=apart, bar=RIGID))
        missed += [f"rigid, {peer}"] if not apart < RIGID else []
    apart, way = path(args.program)
    print(f"centre of mass over 9 s and {way:.2f} m of way against MuJoCo with this drag and servos: apart by {apart:.1e} m (bar {PATH:.0e})")
    rows.append(dict(case="path", apart_m=apart, way_m=way, bar=PATH))
    missed += ["path"] if not apart < PATH else []
    if not args.quick:
        missed += times(args.program, rows)
    for row in rows:
        if "ratio" in row:
            print(f"{row['case']}: {row['ratio']:.1f}x (bar {row['bar']}x)")
    if args.json:
        with open(args.json, "w") as file:
            json.dump(rows, file, indent=1)
    if missed:
        raise SystemExit("missed: " + ", ".join(missed))


if __name__ == "__main__":
    main()
