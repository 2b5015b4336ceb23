"""Our swimmer in three dimensions beside MuJoCo and Pinocchio.

    python compare.py PROGRAM [--json FILE]

PROGRAM is `peer_3d` of froude-swim's examples. Chains of 2 to 20 different links whose joints yaw and pitch at random, a free base,
weight at random centres of mass: accelerations at random states of all three. Then buoyancy and the drag by strips, written here a
second time and put on MuJoCo's links, at random states; and a path of nine seconds with servos, whose accelerations are MuJoCo's and
whose steps are the same RK4 in the same variables (MuJoCo's own steps turn a body by the mean of four rates, which is of second order).

No added mass: neither has it. Exits with 1 when a bar is missed.
"""
import argparse
import json
import subprocess

import mujoco
import numpy as np
import pinocchio as pin

G = 9.80665
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(4)
# Largest differences: of accelerations relative to the largest, of the centre of mass in m.
ACCELERATION, PATH = 1e-9, 1e-9


def ours(program, mode, *numbers):
    data = np.concatenate([np.ravel(x).astype(float) for x in numbers]).tobytes()
    return np.frombuffer(subprocess.run([program, mode], input=data, capture_output=True, check=True).stdout)


class Robot:
    """Links from head to tail, x forward, y to starboard, z down."""

    def __init__(self, rng, n, water):
        self.n = n
        self.l = rng.uniform(0.06, 0.11, n)
        self.m = rng.uniform(0.8, 1.6, n)
        turn = self.m * self.l**2 / 3
        roll = rng.uniform(1e-3, 2e-3, n)
        self.J = np.column_stack([roll, turn + rng.uniform(0, 1, n) * roll, turn + rng.uniform(0, 1, n) * roll])
        small = lambda: np.column_stack([rng.uniform(-s, s, n) for s in (0.02, 0.01, 0.02)])
        self.cm, self.cb = small(), small()
        on = 1.0 if water else 0.0
        self.buoyancy = on * self.m * G * rng.uniform(0.95, 1.05, n)
        self.drag = on * rng.uniform(0, [0.1, 0.8, 0.6, 20.0, 0.4, 12.0, 5e-3, 5e-3], (n, 8))
        self.pitches = rng.integers(0, 2, n - 1)

    def numbers(self):
        rows = np.column_stack([self.l, self.m, self.J, self.cm, self.buoyancy, self.cb, self.drag])
        return np.concatenate([[self.n], rows.ravel(), self.pitches])

    def axis(self, i):
        return (0, 1, 0) if self.pitches[i - 1] else (0, 0, 1)

    def mjcf(self):
        """Each body's origin is the joint before it; the head's is its centre."""
        text, close = "", ""
        row = lambda x: " ".join(repr(float(v)) for v in x)
        for i in range(self.n):
            at = (0, 0, 0) if i == 0 else (-(self.l[0] if i == 1 else 2 * self.l[i - 1]), 0, 0)
            centre = self.cm[i] + (0 if i == 0 else np.array([-self.l[i], 0, 0]))
            joint = "<freejoint/>" if i == 0 else f'<joint name="j{i}" axis="{row(self.axis(i))}"/>'
            text += (f'<body name="b{i}" pos="{row(at)}"><inertial pos="{row(centre)}" mass="{float(self.m[i])!r}" '
                     f'diaginertia="{row(self.J[i])}"/>{joint}')
            close += "</body>"
        return (f'<mujoco><compiler angle="radian"/><option gravity="0 0 {G}"><flag contact="disable"/></option>'
                f"<worldbody>{text}{close}</worldbody></mujoco>")

    def pinocchio(self):
        model = pin.Model()
        model.gravity = pin.Motion(np.array([0, 0, G]), np.zeros(3))
        parent = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "head")
        model.appendBodyToJoint(parent, pin.Inertia(self.m[0], self.cm[0], np.diag(self.J[0])), pin.SE3.Identity())
        for i in range(1, self.n):
            at = pin.SE3(np.eye(3), np.array([-(self.l[0] if i == 1 else 2 * self.l[i - 1]), 0, 0]))
            kind = pin.JointModelRY() if self.pitches[i - 1] else pin.JointModelRZ()
            parent = model.addJoint(parent, kind, at, f"j{i}")
            centre = self.cm[i] + np.array([-self.l[i], 0, 0])
            model.appendBodyToJoint(parent, pin.Inertia(self.m[i], centre, np.diag(self.J[i])), pin.SE3.Identity())
        return model

    def load(self, i, turn, way, down):
        """Moment about the centre of a link and force, by drag and buoyancy, in its own axes."""
        (a1, a2), (s1, s2), (u1, u2), (r1, r2) = self.drag[i].reshape(4, 2)
        x = self.l[i] * POINTS
        v, w = way[1] + x * turn[2], way[2] - x * turn[1]
        size = np.hypot(v, w)
        fy, fz = -0.5 * WEIGHTS * (s1 + s2 * size) * v, -0.5 * WEIGHTS * (u1 + u2 * size) * w
        force = np.array([-(a1 + a2 * abs(way[0])) * way[0], fy.sum(), fz.sum()])
        moment = np.array([-(r1 + r2 * abs(turn[0])) * turn[0], -(x * fz).sum(), (x * fy).sum()])
        lift = -self.buoyancy[i] * down
        return moment + np.cross(self.cb[i], lift), force + lift


def matrix(q):
    out = np.zeros(9)
    mujoco.mju_quat2Mat(out, q)
    return out.reshape(3, 3)


def by_mujoco(robot, model, data, place, q, head, phi, rate, torque):
    """Rates of the head's motion in its own axes, and of the joints."""
    R = matrix(q)
    n = robot.n
    # phi is the angle of the link before less that of the link: hinges turn the other way.
    data.qpos[:] = np.concatenate([place, q, -phi])
    data.qvel[:] = np.concatenate([R @ head[3:], head[:3], -rate])
    applied = np.concatenate([np.zeros(6), -torque])
    if robot.buoyancy.any():
        mujoco.mj_fwdPosition(model, data)
        jp, jr = np.zeros((3, model.nv)), np.zeros((3, model.nv))
        for i in range(n):
            body = i + 1
            axes = data.xmat[body].reshape(3, 3)
            centre = data.xpos[body] + axes @ np.array([0.0 if i == 0 else -robot.l[i], 0, 0])
            mujoco.mj_jac(model, data, jp, jr, centre, body)
            moment, force = robot.load(i, axes.T @ (jr @ data.qvel), axes.T @ (jp @ data.qvel), axes[2])
            applied += jp.T @ (axes @ force) + jr.T @ (axes @ moment)
    data.qfrc_applied[:] = applied
    mujoco.mj_forward(model, data)
    a = data.qacc
    return np.concatenate([a[3:6], R.T @ a[:3] - np.cross(head[:3], head[3:]), -a[6:]])


def random_states(rng, n, count):
    out = []
    for _ in range(count):
        q = rng.normal(size=4)
        out.append((q / np.linalg.norm(q), rng.normal(size=6), 0.5 * rng.normal(size=n - 1), rng.normal(size=n - 1), rng.normal(size=n - 1)))
    return out


def accelerations(program, water):
    """Largest difference at random states, of each peer."""
    rng, worst = np.random.default_rng(15), {"mujoco": 0.0} if water else {"mujoco": 0.0, "pinocchio": 0.0}
    for n in (2, 3, 5, 10, 20):
        robot = Robot(rng, n, water)
        states = random_states(rng, n, 20)
        found = ours(program, "accelerations", robot.numbers(), *[np.concatenate(s) for s in states]).reshape(20, n + 5)
        model = mujoco.MjModel.from_xml_string(robot.mjcf())
        data = mujoco.MjData(model)
        pmodel = robot.pinocchio()
        pdata = pmodel.createData()
        for row, (q, head, phi, rate, torque) in zip(found, states):
            theirs = {"mujoco": by_mujoco(robot, model, data, np.zeros(3), q, head, phi, rate, torque)}
            if not water:
                # Its quaternion ends with w, its motions begin with the way.
                pq = np.concatenate([np.zeros(3), q[1:], q[:1], -phi])
                pv = np.concatenate([head[3:], head[:3], -rate])
                a = pin.aba(pmodel, pdata, pq, pv, np.concatenate([np.zeros(6), -torque]))
                theirs["pinocchio"] = np.concatenate([a[3:6], a[:3], -a[6:]])
            for peer, a in theirs.items():
                worst[peer] = max(worst[peer], np.abs(row - a).max() / np.abs(a).max())
    return worst


def path(program, seconds=9.0, h=1e-3, every=100):
    """Largest distance of the centres of mass, and the way, m."""
    robot = Robot(np.random.default_rng(9), 8, True)
    kp, kd, amplitude, frequency, phase = 20.0, 1.0, np.radians(25), np.radians(120), np.radians(45)
    steps = round(seconds / h)
    mine = ours(program, "path", robot.numbers(), [kp, kd, amplitude, frequency, phase, h, steps, every]).reshape(-1, 3)
    model = mujoco.MjModel.from_xml_string(robot.mjcf())
    data = mujoco.MjData(model)
    j = robot.n - 1

    def rates(t, s):
        q, phi, head, rate = s[3:7] / np.linalg.norm(s[3:7]), s[7 : 7 + j], s[7 + j : 13 + j], s[13 + j :]
        wave = frequency * t - np.arange(j) * phase
        torque = kp * (amplitude * np.sin(wave) - phi) + kd * (amplitude * frequency * np.cos(wave) - rate)
        a = by_mujoco(robot, model, data, s[:3], q, head, phi, rate, torque)
        w, x, y, z = s[3:7]
        p, r, n = head[:3]
        turning = 0.5 * np.array([-x * p - y * r - z * n, w * p + y * n - z * r, w * r + z * p - x * n, w * n + x * r - y * p])
        return np.concatenate([matrix(q) @ head[3:], turning, rate, a])

    s = np.zeros(13 + 2 * j)
    s[3] = 1.0
    theirs = []
    for i in range(steps + 1):
        if i % every == 0:
            data.qpos[:] = np.concatenate([s[:7], -s[7 : 7 + j]])
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            theirs.append(data.subtree_com[1].copy())
        t = i * h
        k1 = rates(t, s)
        k2 = rates(t + h / 2, s + h / 2 * k1)
        k3 = rates(t + h / 2, s + h / 2 * k2)
        k4 = rates(t + h, s + h * k3)
        s = s + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        s[3:7] /= np.linalg.norm(s[3:7])
    theirs = np.array(theirs)
    return np.linalg.norm(mine - theirs, axis=1).max(), np.linalg.norm(theirs[-1] - theirs[0])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--json")
    args = parser.parse_args()
    rigid, water = accelerations(args.program, False), accelerations(args.program, True)
    away, way = path(args.program)
    print(f"MuJoCo {mujoco.__version__}, Pinocchio {pin.__version__}")
    print(f"accelerations, rigid with weight: {', '.join(f'{p} {d:.1e}' for p, d in rigid.items())} of the largest (bar {ACCELERATION:.0e})")
    print(f"accelerations, with buoyancy and drag: mujoco {water['mujoco']:.1e} of the largest (bar {ACCELERATION:.0e})")
    print(f"path of 9 s with servos, weight, buoyancy and drag: centre of mass within {away:.1e} m on a way of {way:.2f} m (bar {PATH:.0e} m)")
    if args.json:
        with open(args.json, "w") as file:
            json.dump({"rigid": rigid, "water": water, "path_m": away, "way_m": way}, file, indent=2)
    is_met = max([*rigid.values(), *water.values()]) < ACCELERATION and away < PATH
    raise SystemExit(0 if is_met else 1)


if __name__ == "__main__":
    main()
