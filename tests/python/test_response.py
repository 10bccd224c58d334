# SPDX-License-Identifier: MIT
"""The response's frames are those of the C interface; its state can be copied; what it refuses is named."""

import copy
import pickle
import subprocess
import tempfile
import threading
import unittest
from pathlib import Path

import numpy as np
import spherechain
from spherechain import _native

from palettes import rest_pose
from paths import DOLL, REFERENCE

FRAMES, SECONDS = 96, 1 / 32
PLACE = np.array(((0.25, 0.5, 0), (0, 0.6, 0, 0.8), (1, 1, 1)), spherechain.TRANSFORM)


def parents_of(model):
    """Joints hang on each other as the body parts that follow them do."""
    parents = [-1] * len(model.bones)
    for part in model.parts:
        if part.bone is not None and part.parent is not None and model.parts[part.parent].bone != part.bone:
            parents[part.bone] = model.parts[part.parent].bone
    return parents


def clip_of(model, parents, frames=FRAMES):
    """(frames, joints): arms swing into the body, each joint at its own pace."""
    places = np.array([-bone.inverse_bind[:, :3].T @ bone.inverse_bind[:, 3] for bone in model.bones])
    out = np.zeros((frames, len(parents)), spherechain.TRANSFORM)
    above = np.where(np.array(parents)[:, None] < 0, 0, places[parents])
    out["translation"] = places - above
    out["scale"] = 1
    out["rotation"] = (0, 0, 0, 1)
    time = np.arange(frames)[:, None] * SECONDS
    for part in model.parts:  # upper arms go down from the horizontal, forearms bend to the front
        is_upper = part.name.endswith(" upper arm")
        if is_upper or part.name.endswith(" forearm"):
            sign = 1 if part.side == "right" else -1
            angle = (0.9 + 0.7 * np.sin(2 * time + sign) if is_upper else 0.8 + 0.8 * np.sin(3 * time)) / 2
            out["rotation"][:, part.bone] = np.hstack([0.2 * np.sin(angle), (not is_upper) * -sign * np.sin(angle),
                                                       is_upper * sign * np.sin(angle), np.cos(angle)])
    out["rotation"] /= np.linalg.norm(out["rotation"], axis=2, keepdims=True)
    return out


class ResponseTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.model = spherechain.Model(DOLL)
        cls.parents = parents_of(cls.model)
        cls.clip = clip_of(cls.model, cls.parents)
        cls.rest = rest_pose(cls.model)

    def play(self, response, state, frames, **options):
        return [response.respond(state, joints, SECONDS, **options) for joints in frames]

    def test_frames_are_those_of_the_c_interface_bit_by_bit(self):
        with tempfile.TemporaryDirectory() as folder:
            files = {name: Path(folder, name) for name in ("bones", "parents", "joints")}
            files["bones"].write_bytes(self.rest.tobytes())
            files["parents"].write_bytes(np.array(self.parents, np.int32).tobytes())
            files["joints"].write_bytes(self.clip.tobytes())
            data = subprocess.run([REFERENCE, DOLL, *files.values()], capture_output=True, check=True).stdout
        response = spherechain.Response(self.model, self.parents)
        at, turned, rows, sides = 0, [0, 0], 0, set()
        for with_options in (False, True):
            state = spherechain.ResponseState()
            for i, joints in enumerate(self.clip):
                options = {} if not with_options else {
                    "place": PLACE, "weakness": 0.25, "rounds": 2, "ahead": self.clip[min(i + 1, FRAMES - 1)], "ahead_frames": 1,
                    "others": [spherechain.Posed(self.model, self.rest)], "ground": spherechain.Ground((0, 1, 0), 0.75),
                    "planted": [2]}
                before = joints.copy()
                found = response.respond(state, joints, SECONDS, **options)
                self.assertEqual(joints.tobytes(), before.tobytes())
                expected = (found.joints.tobytes() + np.array([found.turned, found.at_budget], np.uint32).tobytes()
                            + np.float32(found.remaining).tobytes() + np.uint64(len(found.rows)).tobytes() + found.rows.tobytes())
                self.assertEqual(data[at:at + len(expected)], expected, f"frame {i}")
                at += len(expected)
                turned[with_options] += found.turned
                self.assertEqual(found.turned == 0, found.joints.tobytes() == joints.tobytes())
                rows += len(found.rows)
                sides |= set(found.rows["body"].tolist())
            self.assertEqual(data[at:at + state.words.nbytes], state.words.tobytes())
            at += state.words.nbytes
        self.assertEqual(at, len(data))
        self.assertTrue(min(turned) > 20 and rows > 20, (turned, rows))
        self.assertLessEqual({0, 1}, sides)

    def test_a_copied_state_replays_the_same(self):
        response, state = spherechain.Response(self.model, self.parents), spherechain.ResponseState()
        self.play(response, state, self.clip[:40])
        copies = [state.copy(), copy.copy(state), copy.deepcopy(state), pickle.loads(pickle.dumps(state))]
        expected = [found.joints.tobytes() for found in self.play(response, state, self.clip[40:60])]
        for other in copies:
            again = self.play(spherechain.Response(self.model, self.parents), other, self.clip[40:60])
            self.assertEqual([found.joints.tobytes() for found in again], expected)
        state.reset()
        self.assertFalse(state.words.any())

    def test_plain_arrays_give_what_structured_ones_give(self):
        response = spherechain.Response(self.model, [None if parent < 0 else parent for parent in self.parents])
        plain = self.clip.view(np.float32).reshape(FRAMES, -1, 10)
        place = np.array([0.25, 0.5, 0, 0, 0.6, 0, 0.8, 1, 1, 1], np.float32)
        found = self.play(response, spherechain.ResponseState(), plain, place=place)
        structured = self.play(response, spherechain.ResponseState(), self.clip, place=PLACE)
        self.assertEqual(found[0].joints.shape, (len(self.parents), 10))
        self.assertEqual(structured[0].joints.dtype, spherechain.TRANSFORM)
        self.assertEqual([f.joints.tobytes() for f in found], [f.joints.tobytes() for f in structured])
        strided = self.play(response, spherechain.ResponseState(), np.asfortranarray(plain), place=place)
        self.assertEqual([f.joints.tobytes() for f in found], [f.joints.tobytes() for f in strided])

    def test_options_of_the_response(self):
        count = len(self.parents)

        def turns(**options):
            response = spherechain.Response(self.model, self.parents, **options)
            return sum(found.turned for found in self.play(response, spherechain.ResponseState(), self.clip))

        free = turns()
        self.assertGreater(free, 0)
        self.assertEqual(turns(mobility=[0] * count), 0)
        self.assertEqual(turns(part_pairs=[]), 0)
        self.assertEqual(turns(budget=[0] * count), 0)
        self.assertNotEqual(turns(part_pairs=[(0, len(self.model.parts) - 1)]), free)

    def test_joints_of_an_engine_come_in_its_order(self):
        order = np.random.default_rng(5).permutation(len(self.parents))
        place_of = np.argsort(order)
        bound = spherechain.Model(DOLL, [self.model.bones[i].name for i in order])
        parents = [None if self.parents[i] < 0 else int(place_of[self.parents[i]]) for i in order]
        own = self.play(spherechain.Response(bound, parents), spherechain.ResponseState(), self.clip[:, order])
        other = self.play(spherechain.Response(self.model, self.parents), spherechain.ResponseState(), self.clip)
        for a, b in zip(own, other):
            self.assertEqual(a.turned, b.turned)

    def test_refusals_name_the_argument(self):
        count = len(self.parents)
        response, state = spherechain.Response(self.model, self.parents), spherechain.ResponseState()

        def make(text, parents=self.parents, error=ValueError, **options):
            with self.assertRaisesRegex(error, text):
                spherechain.Response(self.model, parents, **options)

        make("^parents: ", [1, 0, *self.parents[2:]])
        make(r"^parents\[2\] is 99: there are", [*self.parents[:2], 99, *self.parents[3:]])
        make(r"^parents\[0\] is -2", [-2, *self.parents[1:]])
        make("^parents: pass", [0.5] * count)
        make("^joints: ", self.parents[:2])
        make("^mobility has the shape", mobility=[1.0])
        make("^joints: ", mobility=[2.0] * count)
        make("^joints: ", mobility=[1.0] * count, budget=[3.0] * count)
        make(r"^budget\[0\] is nan", budget=[np.nan] * count)
        make("^part_pairs has 0, 99", part_pairs=[(0, 99)])
        make("rule", rule=3, error=TypeError)
        make("rule", rule=spherechain.Rule(touch_depth=np.nan))
        make("pass a spherechain.Model", largest_other=3, error=TypeError)

        joints = self.clip[30]
        broken = joints.copy()
        broken["rotation"][2, 1] = np.nan
        posed = spherechain.Posed(self.model, self.rest)

        def respond(text, error=ValueError, own=joints, seconds=SECONDS, own_state=state, **options):
            before = state.words.copy()
            with self.assertRaisesRegex(error, text):
                response.respond(own_state, own, seconds, **options)
            np.testing.assert_array_equal(state.words, before)

        self.play(response, state, self.clip[:30])
        respond("^state is dict: pass", TypeError, own_state={})
        respond(r"^joints\[2, 4\] is nan", own=broken)
        respond(r"^joints has the shape", own=joints[1:])
        respond(r"^joints is float64: pass float32", TypeError, own=np.zeros((count, 10)))
        respond("^transform: ", own=np.zeros(count, spherechain.TRANSFORM))
        respond("^seconds is -1", seconds=-1)
        respond("^seconds is nan", seconds=np.nan)
        respond("^weakness is 2", weakness=2)
        respond("^rounds is 17", rounds=17)
        respond("^rounds is 1.5", rounds=1.5)
        respond("^ahead_frames is 4", ahead=joints, ahead_frames=4)
        respond("^ahead, ahead_frames: pass both", ahead=joints)
        respond("^ahead, ahead_frames: pass both", ahead_frames=1)
        respond("^ahead has the shape", ahead=joints[1:], ahead_frames=1)
        respond("^place has the shape", place=joints)
        respond("no morph targets", morph_weights=np.zeros(3, np.float32))
        respond(r"^others\[1\] is int", TypeError, others=[posed, 3])
        respond("^others has 9 bodies", others=[posed] * 9)
        respond(r"^others\[0\] has poses \(1,\): pass one", others=[spherechain.Posed(self.model, self.rest[None])])
        respond("^ground: pass", ground=((0, 2, 0), 0))
        respond("^planted is -1", planted=[-1])
        respond("^joints: ", planted=[0] * 5)
        self.assertEqual(len(self.play(response, state, self.clip[30:31], others=[posed] * 8)), 1)

    def test_the_module_itself_reads_nothing_out_of_bounds(self):
        model, count, rule = self.model._native, len(self.parents), list(spherechain.Rule())
        parents = np.array(self.parents).astype(np.uint32)
        good = _native.Response(model, parents, None, None, None, None, rule, None)
        for arguments in ((parents[::2], None, None, None, None, rule),
                          (parents, np.zeros(count - 1, np.float32), None, None, None, rule),
                          (parents, None, np.zeros((1, count), np.float32), None, None, rule),
                          (parents, None, None, np.zeros((count, 2), np.float32), None, rule),
                          (parents, None, None, None, np.zeros(1, np.uint64), rule),
                          (parents, None, None, None, None, rule[1:])):
            with self.assertRaisesRegex(ValueError, "parents|mobility|budget|hinges|part_pairs|rule"):
                _native.Response(model, *arguments, None)
        joints = np.zeros((count, 10), np.float32)
        fixed = joints.copy()
        fixed.flags.writeable = False
        state = np.zeros(_native.RESPONSE_WORDS, np.uint64)
        frame = dict(seconds=0.03, weakness=0, rounds=0, ahead_frames=0, place=None, ahead=None, morph_weights=None,
                     others=[], ground=None, planted=np.zeros(0, np.uint32))
        for own, words, options in ((joints[1:], state, {}), (fixed, state, {}), (joints, state[1:], {}),
                                    (joints, state, {"place": joints[0]}), (joints, state, {"ahead": joints[1:]}),
                                    (joints, state, {"planted": np.zeros((1, 2), np.uint32)}),
                                    (joints, state, {"others": [(model, (self.rest[None, 1:], None, None))]}),
                                    (joints, state, {"others": [(model, (np.stack([self.rest] * 2), None, None))]})):
            with self.assertRaisesRegex(ValueError, "joints|state|place|ahead|planted|bones|others"):
                good.respond(words, own, {**frame, **options})

    def test_threads_that_share_a_response_get_right_frames_or_a_refusal(self):
        response = spherechain.Response(self.model, self.parents)
        expected = [found.joints.tobytes() for found in self.play(response, spherechain.ResponseState(), self.clip)]
        results, refused = [], []

        def run():
            state, out = spherechain.ResponseState(), []
            for joints in self.clip:
                while True:
                    try:
                        out.append(response.respond(state, joints, SECONDS).joints.tobytes())
                        break
                    except RuntimeError as error:
                        refused.append(str(error))
            results.append(out)

        threads = [threading.Thread(target=run) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(results, [expected] * 3)
        self.assertLessEqual(set(refused), {"the response is in use: make one for each thread"})


if __name__ == "__main__":
    unittest.main()
