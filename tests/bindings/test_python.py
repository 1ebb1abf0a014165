"""Tests examples/python/gxfem.py. usage: python3 test_python.py BITS, with the library in GXFEM_LIBRARY
BITS: what the program of bits.c has printed"""
import gc
import os
import sys
import unittest

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..', 'examples', 'python'))
import gxfem  # noqa: E402
from gxfem import native  # noqa: E402

POSITIONS = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
ELEMENTS = np.array([[0, 1, 2, 4], [3, 1, 7, 2], [5, 1, 4, 7], [6, 2, 7, 4], [1, 2, 4, 7]], np.uint32)
SHEET = np.array([[-1, -1, .4], [3, -1, .45], [3, 3, .5], [-1, 3, .5]]), np.array([[0, 1, 2], [0, 2, 3]], np.uint32)


def cube(low, high):
    vertices = [[(low, high)[i >> k & 1] for k in range(3)] for i in range(8)]
    faces = [[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4], [2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5]]
    return np.array(vertices, float), np.array(faces, np.uint32)


class Tests(unittest.TestCase):
    def body(self, **desc):
        return gxfem.Body(POSITIONS, ELEMENTS, **{'young': 3e3, 'poisson': .35, 'density': 800, **desc})

    def test_bits_are_those_of_c(self):
        body = self.body()
        body.hold(gxfem.half_space(2, -1, .1))
        for i in range(10):
            if i == 3:
                body.cut(SHEET)
            body.step(1 / 60, gravity=(0, 0, -9.81), integrator=native.GXS_BDF2)
        with open(BITS, encoding='ascii') as file:
            hashes, *numbers = file.read().split('\n')[:-1]
        self.assertEqual([float.fromhex(n) for n in numbers], body.view().displacement.ravel().tolist())
        topology = body.topology_hash()
        self.assertEqual(hashes, f'{topology:016x} {native.gx_body_state_hash(body._body):016x}')

    def test_nothing_is_copied(self):
        body = self.body()
        first, again = body.view(), body.view()
        for name in ('displacement', 'velocity', 'cell_copies', 'fragment_volume'):
            self.assertTrue(np.shares_memory(getattr(first, name), getattr(again, name)), name)
        first.displacement[:] = 0.25
        self.assertEqual(again.displacement.min(), 0.25)
        hit = body.locate([[.5, .5, .5]])[0]
        np.testing.assert_allclose(hit.material[:], [.25, .25, .25], atol=1e-12)
        with self.assertRaises(ValueError):
            first.cell_copies[0, 0] = 1

    def test_arrays_keep_the_body(self):
        volume = self.body().view().fragment_volume
        gc.collect()
        self.assertAlmostEqual(volume.sum(), 1, 12)

    def test_arrays_of_other_types(self):
        body = gxfem.Body(POSITIONS.tolist(), ELEMENTS.astype(np.int64))
        self.assertEqual(body.view().volume, 1)
        with self.assertRaises(ValueError):
            gxfem.Body(POSITIONS[:, :2], ELEMENTS)
        with self.assertRaises(KeyError):
            gxfem.Body(POSITIONS, ELEMENTS, younger=1)

    def test_errors_name_the_field(self):
        body = self.body()
        state = native.gx_body_state_hash(body._body)
        with self.assertRaises(gxfem.Error) as caught:
            body.cut((SHEET[0], [[0, 1, 7]]))
        self.assertEqual((caught.exception.result, caught.exception.field, caught.exception.index, caught.exception.surface),
                         (native.GX_ERROR_INDEX, 'surfaces.triangles', 0, 0))
        self.assertEqual(state, native.gx_body_state_hash(body._body))
        with self.assertRaises(gxfem.Error):
            gxfem.Body(POSITIONS * np.nan, ELEMENTS)

    def test_save_clone_restore(self):
        body = self.body()
        before = body.clone()
        body.cut(SHEET)
        self.assertEqual(body.view().fragment_count, 2)
        loaded = gxfem.Body.load(body.save())
        self.assertEqual(loaded.topology_hash(), body.topology_hash())
        body.restore(before)
        self.assertEqual(body.view().fragment_count, 1)
        with self.assertRaises(gxfem.Error):
            gxfem.Body.load(b'no body')

    def test_solids_skin_pick_motions(self):
        body = self.body()
        report = body.cut(solids=[cube(.25, .75)])
        self.assertAlmostEqual(report['removed_volume'], 1 / 8, 12)
        skin = body.skin()
        x = body.positions()[skin.triangles]
        area = np.linalg.norm(np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), axis=1).sum() / 2
        self.assertAlmostEqual(area, 6 + 6 / 4, 12)
        hit = body.pick([.5, .5, 3], [0, 0, -1])
        self.assertAlmostEqual(hit.position[2], 1, 12)
        self.assertIsNone(body.pick([5, 5, 3], [0, 0, 1]))
        self.assertAlmostEqual(body.motions()[0].mass, 800 * 7 / 8, 9)

    def test_forces(self):
        body = self.body()
        body.step(.01, forces=np.tile([0, 0, 1.], (8, 1)))
        self.assertAlmostEqual(body.motions()[0].velocity[2], 8 * .01 / 800, 9)
        with self.assertRaises(ValueError):
            body.step(.01, forces=np.zeros((7, 3)))

    def test_bodies_touch(self):
        lower, upper = self.body(young=1e6), self.body(young=1e6)
        upper.view().displacement[:] = (0.1, 0.1, 1.02)
        lower.hold(gxfem.half_space(2, -1, .1))
        for body in (lower, upper):
            body.contact(friction=.5)
        group = gxfem.Group(lower, upper)
        pushed = np.zeros((upper.view().copy_count, 3))
        for _ in range(40):
            group.step(1 / 60, loads=({}, {'forces': pushed}), gravity=(0, 0, -9.81))
        self.assertGreater(upper.motions()[0].center[2], 1.2)
        self.assertEqual({(c.body, c.other_body) for c in group.contacts()}, {(0, 1), (1, 0)})
        lower.cut(SHEET)
        with self.assertRaises(gxfem.Error):
            group.contacts()
        lower.contact(False)
        with self.assertRaises(gxfem.Error):
            group.step(1 / 60)

    def test_blade(self):
        body = self.body()
        blade = body.blade()
        pieces = sum(blade.move([[x, -1, .5], [x, 2, .5]])['triangle_count'] for x in np.linspace(-.5, 1.5, 9))
        blade.lift()
        self.assertGreater(pieces, 0)
        self.assertEqual(body.view().fragment_count, 2)
        self.assertGreater(body.carve(cube(-.1, .2))['removed_volume'], 0)

    def test_boolean(self):
        boolean = gxfem.Boolean(fine=True).add(*cube(0, 1)).add(*cube(.5, 1.5), operation=gxfem.Boolean.DIFFERENCE)
        result = boolean.evaluate()
        self.assertAlmostEqual(boolean.components().total_volume, 7 / 8, 14)
        self.assertEqual(set(result.triangle_operand.tolist()), {0, 1})
        with self.assertRaises(gxfem.Error):
            boolean.add(*SHEET)


if __name__ == '__main__':
    BITS = sys.argv.pop(1)
    unittest.main()
