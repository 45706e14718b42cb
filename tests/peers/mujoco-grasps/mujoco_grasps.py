"""Judge of grasps by MuJoCo: keeps a world of objects on a table, and answers each grasp with what
became of it.

Reads one JSON document a line from standard input, and answers each with one. Lengths are metres,
poses are x, y, z, qx, qy, qz, qw in the world (z up).

  {"world": {"table_m": HEIGHT, "objects": [{"id": N, "parts": [[[x, y, z], ...], ...],
   "pose": [...], "density_kg_m3": D, "friction": MU}], "gripper": {...}}}
      settles the objects                     -> {"poses": {"N": [...]}}
  {"grasp": {"pose": [...], "opening_m": W, "approach_m": A, "target": N}}
      approach, close, lift, shake            -> {"held": true, "reason": "", "risen_m": Z,
                                                  "poses": {"N": [...]}}

A part is the convex hull of its points. Mass is density times the volume of the parts, within 10 g
and 3 kg. The hand slides along the axes of the world by servos; its two fingers are coupled and
pressed together by motors with the closing force, so that it can slip.
"""

import argparse
import json
import math
import sys

import mujoco
import numpy as np

TIMESTEP_S = 0.002
SETTLE_S = 0.5
APPROACH_S = 1.0
CLOSE_S = 2.0
LIFT_S = 1.5
LIFT_M = 0.20
SHAKE_S = 1.0
SHAKE_M_S2 = 2.0
SHAKE_HZ = 2.0
MASS_KG = (0.01, 3.0)
# Servo of the hand: stiffness and damping for 1.5 kg, and its greatest force.
HAND_KG = 1.5
HAND_N_M = 6000.0
HAND_N_S_M = 190.0
HAND_N = 400.0
# Inertia of a finger with its motor and gears. The stiffness of a contact grows with the mass
# behind it: without it, 25 N would press a finger through a spoon.
FINGER_KG = 1.0
# Hard contacts: time constant of two steps.
HARD = 'solref="0.004 1" solimp="0.95 0.99 0.001"'
# Share of the lift by which the object must have risen, and its greatest slip in the hand.
RISEN_SHARE = 0.75
SLIP_M = 0.06


def numbers(values):
    return " ".join(f"{value:.9g}" for value in values)


def has_volume(part):
    """True if points span a body; flat parts have no hull."""
    points = np.array(part)
    return len(points) >= 4 and np.linalg.svd(points - points.mean(axis=0), compute_uv=False)[2] > 1e-5


def wxyz(pose):
    return [pose[6], pose[3], pose[4], pose[5]]


class World:
    """Objects with their poses; a model is made anew for each grasp."""

    def __init__(self, document):
        self.table_m = document["table_m"]
        self.objects = document["objects"]
        self.gripper = document["gripper"]
        self.poses = {str(one["id"]): list(one["pose"]) for one in self.objects}

    def object_xml(self):
        meshes, bodies = [], []
        for one in self.objects:
            name = f"object{one['id']}"
            geoms = []
            for index, part in enumerate(filter(has_volume, one["parts"])):
                vertices = numbers(value for point in part for value in point)
                meshes.append(f'<mesh name="{name}-{index}" vertex="{vertices}"/>')
                geoms.append(
                    f'<geom type="mesh" mesh="{name}-{index}" density="{one["density_kg_m3"]}" '
                    f'friction="{one["friction"]} 0.005 0.0001" condim="4" {HARD}/>'
                )
            pose = self.poses[str(one["id"])]
            bodies.append(
                f'<body name="{name}" pos="{numbers(pose[:3])}" quat="{numbers(wxyz(pose))}">'
                f'<freejoint name="{name}"/>{"".join(geoms)}</body>'
            )
        return "".join(meshes), "".join(bodies)

    def hand_xml(self, grasp):
        """The hand at the begin of its approach, fingers open."""
        gripper = self.gripper
        start = shifted(grasp["pose"], -grasp["approach_m"])
        half_pad = 0.5 * gripper["pad_length_m"]
        thickness = gripper["pad_thickness_m"] + gripper["finger_thickness_m"]
        back = -gripper["palm_m"]
        finger_half = [0.5 * thickness, 0.5 * gripper["pad_width_m"], 0.5 * (half_pad - back)]
        reach = 0.5 * gripper["max_opening_m"] + thickness
        speed = 0.5 * gripper["opening_speed_m_s"]
        force = gripper["closing_force_n"]
        friction = f'friction="{gripper["pad_friction"]} 0.005 0.0001" condim="4" priority="1" {HARD}'
        fingers, joints = [], []
        for name, side in (("right", 1.0), ("left", -1.0)):
            middle = side * (0.5 * grasp["opening_m"] + finger_half[0])
            fingers.append(
                f'<body name="{name}" pos="{middle:.6f} 0 {0.5 * (half_pad + back):.6f}" gravcomp="1">'
                f'<joint name="{name}" type="slide" axis="{-side} 0 0" damping="{force / speed:.3f}" '
                f'armature="{FINGER_KG}" range="-0.2 {0.5 * grasp["opening_m"]:.6f}" limited="true" '
                'solreflimit="0.004 1"/>'
                f'<geom name="{name}" type="box" size="{numbers(finger_half)}" mass="0.05" {friction}/>'
                "</body>"
            )
            joints.append(f'<motor joint="{name}" ctrlrange="0 {force}" ctrllimited="true"/>')
        slides = "".join(
            f'<joint name="hand-{axis}" type="slide" axis="{numbers(unit)}" damping="{HAND_N_S_M}"/>'
            for axis, unit in zip("xyz", np.eye(3))
        )
        servos = "".join(
            f'<position joint="hand-{axis}" kp="{HAND_N_M}" forcerange="{-HAND_N} {HAND_N}" '
            'forcelimited="true"/>'
            for axis in "xyz"
        )
        # The slides are along the axes of the world; the turned body is inside.
        body = (
            f'<body name="carrier" pos="{numbers(start[:3])}" gravcomp="1">{slides}'
            f'<geom type="sphere" size="0.005" mass="{HAND_KG - 0.2}" contype="0" conaffinity="0"/>'
            f'<body name="hand" quat="{numbers(wxyz(start))}" gravcomp="1">'
            f'<geom name="palm" type="box" size="{reach:.6f} 0.025 0.015" '
            f'pos="0 0 {back - 0.015:.6f}" mass="0.05"/>'
            f'<geom name="wrist" type="box" size="0.04 0.04 0.06" pos="0 0 {back - 0.09:.6f}" '
            f'mass="0.05"/>{"".join(fingers)}</body></body>'
        )
        coupling = '<equality><joint joint1="right" joint2="left" solref="0.004 1"/></equality>'
        exclude = (
            '<contact><exclude body1="hand" body2="right"/><exclude body1="hand" body2="left"/>'
            '<exclude body1="right" body2="left"/></contact>'
        )
        return body, f"<actuator>{servos}{''.join(joints)}</actuator>{coupling}{exclude}"

    def model(self, grasp=None):
        meshes, bodies = self.object_xml()
        hand, rest = self.hand_xml(grasp) if grasp else ("", "")
        xml = (
            f'<mujoco><option timestep="{TIMESTEP_S}" integrator="implicitfast" cone="elliptic" '
            f'impratio="10"/><compiler angle="radian"/><asset>{meshes}</asset><worldbody>'
            f'<geom name="table" type="box" size="1 1 0.05" pos="0 0 {self.table_m - 0.05:.6f}" '
            f'friction="0.6 0.005 0.0001" condim="4"/>{bodies}{hand}</worldbody>{rest}</mujoco>'
        )
        model = mujoco.MjModel.from_xml_string(xml)
        for one in self.objects:
            body = model.body(f"object{one['id']}").id
            mass = model.body_mass[body]
            scale = min(max(mass, MASS_KG[0]), MASS_KG[1]) / mass * one.get("mass_factor", 1.0)
            model.body_mass[body] *= scale
            model.body_inertia[body] *= scale
        data = mujoco.MjData(model)
        mujoco.mj_setConst(model, data)
        mujoco.mj_forward(model, data)
        return model, data

    def keep_poses(self, data):
        for one in self.objects:
            x, y, z, qw, qx, qy, qz = data.joint(f"object{one['id']}").qpos
            self.poses[str(one["id"])] = [x, y, z, qx, qy, qz, qw]

    def settle(self):
        model, data = self.model()
        for _ in range(round(SETTLE_S / TIMESTEP_S)):
            mujoco.mj_step(model, data)
        self.keep_poses(data)
        return {"poses": self.poses}

    def attempt(self, grasp):
        model, data = self.model(grasp)
        target = data.body(f"object{grasp['target']}")
        begin_z = target.xpos[2]
        forward = np.array(shifted(grasp["pose"], grasp["approach_m"])[:3]) - grasp["pose"][:3]
        mover = Mover(model, data)
        begin = target.xpos.copy()
        mover.move(forward, APPROACH_S, closing=False)
        pushed = float(np.linalg.norm(target.xpos - begin))
        mover.hold(CLOSE_S)
        opening = grasp["opening_m"] - sum(data.joint(name).qpos[0] for name in ("right", "left"))
        in_hand = relative(data, target)
        mover.move(np.array([0.0, 0.0, LIFT_M]), LIFT_S)
        risen_before = target.xpos[2] - begin_z
        for axis in range(3):
            mover.shake(axis)
        risen = target.xpos[2] - begin_z
        slip = float(np.linalg.norm(relative(data, target) - in_hand))
        if risen_before < RISEN_SHARE * LIFT_M:
            reason = (
                f"not lifted: pushed by {1e3 * pushed:.0f} mm on the approach, "
                f"fingers closed to {1e3 * opening:.0f} mm"
            )
        elif risen < RISEN_SHARE * LIFT_M:
            reason = "lost when it was shaken"
        elif slip > SLIP_M:
            reason = f"slipped by {1e3 * slip:.0f} mm"
        else:
            reason = ""
        self.keep_poses(data)
        return {
            "held": not reason,
            "reason": reason,
            "risen_m": float(risen),
            "slip_m": slip,
            "poses": self.poses,
        }


class Mover:
    """Moves the hand along straight lines with smooth speed."""

    def __init__(self, model, data):
        self.model, self.data = model, data
        self.at = np.zeros(3)
        self.force = model.actuator_ctrlrange[3][1]

    def step(self, place, closing):
        self.data.ctrl[:3] = place
        self.data.ctrl[3:] = self.force if closing else 0.0
        mujoco.mj_step(self.model, self.data)

    def move(self, way, duration_s, closing=True):
        n_steps = round(duration_s / TIMESTEP_S)
        for step in range(1, n_steps + 1):
            share = 0.5 - 0.5 * math.cos(math.pi * step / n_steps)
            self.step(self.at + way * share, closing)
        self.at = self.at + way
        self.settle(closing)

    def settle(self, closing):
        for _ in range(round(0.2 / TIMESTEP_S)):
            self.step(self.at, closing)

    def hold(self, duration_s):
        for _ in range(round(duration_s / TIMESTEP_S)):
            self.step(self.at, True)

    def shake(self, axis):
        omega = 2.0 * math.pi * SHAKE_HZ
        amplitude = SHAKE_M_S2 / omega**2
        for step in range(round(SHAKE_S / TIMESTEP_S)):
            place = self.at.copy()
            place[axis] += amplitude * (1.0 - math.cos(omega * step * TIMESTEP_S))
            self.step(place, True)


def shifted(pose, forward_m):
    """Pose moved along its own z axis."""
    rotation = np.zeros(9)
    mujoco.mju_quat2Mat(rotation, np.array(wxyz(pose)))
    return list(np.array(pose[:3]) + rotation.reshape(3, 3)[:, 2] * forward_m) + list(pose[3:])


def relative(data, target):
    """Place of an object in the frame of the hand."""
    hand = data.body("hand")
    return hand.xmat.reshape(3, 3).T @ (target.xpos - hand.xpos)


def serve():
    world = None
    for line in sys.stdin:
        try:
            document = json.loads(line)
            if "world" in document:
                world = World(document["world"])
                answer = world.settle()
            elif world is None:
                answer = {"error": "there is no world yet; send one first"}
            else:
                answer = world.attempt(document["grasp"])
        except (ValueError, KeyError, TypeError, mujoco.FatalError) as error:
            answer = {"error": f"{type(error).__name__}: {error}"}
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Judge of grasps by MuJoCo.")
    parser.add_argument("--serve", action="store_true", required=True, help="answer JSON lines")
    parser.parse_args()
    serve()
