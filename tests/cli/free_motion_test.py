"""Bodies that nobody holds, as a run file tells of them: scenes of tests/outside. What is asked of them is computed from
recorded poses, velocities and forces alone."""
import os
import unittest

import h5py
import numpy as np

from program import ProgramTest, SOURCE

DENSITY = 1000


def turned(q, v):
    """Vectors v in the world, of bodies with orientations q (x, y, z, w)."""
    u, w = q[:, :3], q[:, 3:]
    return v + 2 * np.cross(u, np.cross(u, v) + w * v)


class FreeMotion(ProgramTest):
    def run_scene(self, scene, **settings):
        run_file = self.path("run.h5")
        options = [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]
        self.run_json("run", os.path.join(SOURCE, "tests", "outside", scene + ".lua"), "-o", run_file, "--force", *options)
        return h5py.File(run_file)

    def motion(self, f, body, density):
        """Position, momentum and spin about the centre of mass, frame by frame. Centres are the bodies' origins."""
        models = f["inputs/models"]  # a solid of which both bodies are is stored once
        model = models["1" if body == "b" and "1" in models else "0"]["0/mass"][()]
        pose, twist = f[f"state/body/{body}/pose"][()], f[f"state/body/{body}/twist"][()]
        inertia = density * model[4:].reshape(3, 3)
        spin_B = turned(pose[:, 3:] * [-1, -1, -1, 1], twist[:, 3:]) @ inertia
        return pose[:, :3], density * model[0] * twist[:, :3], turned(pose[:, 3:], spin_B)

    def test_a_spin_keeps_its_energy_and_its_axis(self):
        for integrator in ("semi-implicit", "implicit"):
            for spin, timestep in (((5, 0.1, 0.1), 0.001), ((5, 0.1, 0.1), 0.005), ((0.01, 0, 20), 0.001)):
                with self.subTest(integrator=integrator, spin=spin, timestep=timestep), self.run_scene(
                        "spin_gains_energy", wx=spin[0], wy=spin[1], wz=spin[2], integrator=integrator,
                        timestep=timestep) as f:
                    kinetic = f["state/energy"][:, 0]
                    turning = kinetic - 0.5 * 1 * 0.3 ** 2  # 1 kg at 0.3 m/s
                    self.assertLess(np.abs(turning / turning[0] - 1).max(), 1e-4)
                    q = f["state/body/b/pose"][:, 3:]
                    axis = turned(q, np.tile([0.0, 0, 1], (len(q), 1)))
                    if spin[2] == 20:
                        self.assertGreater((axis @ axis[0]).min(), np.cos(np.radians(0.1)))
                    else:
                        self.assertLess((axis @ axis[0]).min(), 0, "it tumbles: else this would prove nothing")

    def test_two_bodies_keep_their_momentum(self):
        """1e-9 of the summed magnitudes; the forces on both are equal and opposite, about one point."""
        methods = [(h, i) for h in ("off", "restore", "blend") for i in ("semi-implicit", "implicit")] + [("exact", "implicit")]
        kinds = [("pegring", 1), ("boxes", 1), ("boxes", 1000), ("spheres", 1), ("cylinders", 0.001)]
        for kind, ratio in kinds:
            for hybrid, integrator in methods:
                with self.subTest(kind=kind, ratio=ratio, hybrid=hybrid, integrator=integrator), self.run_scene(
                        "two_free_bodies", kind=kind, ratio=ratio, hybrid=hybrid, integrator=integrator) as f:
                    self.check_momentum(f, ratio)

    def check_momentum(self, f, ratio):
        dt = f["state/time"][1] - f["state/time"][0]
        linear, angular, force, torque = 0, 0, 0, 0
        linear_size, angular_size = 0, 0
        for body, density in (("a", DENSITY), ("b", DENSITY * ratio)):
            p, momentum, spin = self.motion(f, body, density)
            w = f[f"state/body/{body}/force"][1:]
            at = p[:-1]  # where the body was when the contacts of the step were found
            linear = linear + momentum
            angular = angular + np.cross(p, momentum) + spin
            force = force + w[:, :3]
            torque = torque + w[:, 3:] + np.cross(at, w[:, :3])
            sizes = [np.linalg.norm(x, axis=1) for x in (w[:, :3], w[:, 3:], at, momentum, spin, p)]
            linear_size += sizes[3][0] + dt * sizes[0].sum()
            angular_size += sizes[4][0] + (sizes[5] * sizes[3])[0] + dt * (sizes[1] + sizes[2] * sizes[0]).sum()
        self.assertGreater(linear_size, 0)
        self.assertLess(np.linalg.norm(linear - linear[0], axis=1).max(), 1e-9 * linear_size)
        self.assertLess(np.linalg.norm(angular - angular[0], axis=1).max(), 1e-9 * angular_size)
        self.assertLess(dt * np.linalg.norm(force, axis=1).max(), 1e-9 * linear_size)
        self.assertLess(dt * np.linalg.norm(torque, axis=1).max(), 1e-9 * angular_size)


if __name__ == "__main__":
    unittest.main()
