"""The Python package has all that the headers have, with their words; their structures are its classes."""

import gc
import pathlib
import re
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import python_package  # noqa: E402
import script  # noqa: E402

planefold = python_package.enter()
import numpy as np  # noqa: E402


def words(text):
    """Without stars, breaks and differences of blanks."""
    return re.sub(r"\s+", " ", re.sub(r"\n\s*\* ?", " ", text)).strip()


class Words(unittest.TestCase):
    """Nothing of the headers is missing, and every docstring is a comment of theirs."""

    library = [path.read_text() for path in sorted((script.SOURCE / "lib/include/planefold").glob("*.h"))]
    platform = [(script.SOURCE / f"platform/include/planefold_platform/{name}.h").read_text() for name in ("sim", "sequence", "walls")]
    headers = words("\n".join(library + platform))

    def test_docstrings_of_structures_are_the_headers_comments(self):
        seen = 0
        for name, kind in vars(planefold).items():
            if not isinstance(kind, type) or not hasattr(kind, "copy") or name in ("Slam",):
                continue
            for field, attribute in [*vars(kind).items(), (name, kind)]:
                if field.startswith("_") or field == "copy" or not attribute.__doc__:
                    continue
                for part in attribute.__doc__.split("\n\n"):
                    self.assertIn(words(part), self.headers, f"{name}.{field}")
                    seen += 1
        self.assertGreater(seen, 150)

    def test_docstring_of_a_function_is_its_comment(self):
        for function, comment in ((planefold.Slam.hit_test, "pf_hit_test"), (planefold.Slam.push_imu, "pf_push_imu"),
                                  (planefold.read_target, "pf_read_target"), (planefold.Slam.add_wall, "pf_add_wall")):
            text = "\n".join(self.library + self.platform)
            end = re.search(rf"\*/\n[^*\n]*\b{comment}\(", text).start()
            self.assertIn(words(text[text.rindex("/*", 0, end) + 2:end]), words(function.__doc__), comment)

    def test_every_function_of_the_library_is_offered(self):
        bindings = "\n".join(path.read_text() for path in (script.SOURCE / "tools/python/bindings").glob("*.cpp"))
        declared = re.findall(r"PF_API[^;(]*?\b(pf_\w+)\s*\(", "\n".join(self.library))
        self.assertGreater(len(declared), 30)
        self.assertEqual([name for name in declared if not re.search(rf"\b{name}\b", bindings)], [])

    def test_every_field_and_value_is_offered(self):
        text = re.sub(r"/\*.*?\*/", "", "\n".join(self.library), flags=re.S)
        for body, name in re.findall(r"typedef struct \w+ \{(.*?)\n\} (\w+);", text, re.S):
            if name in ("pf_image_t", "pf_rectangle_t", "pf_mask_t"):  # arrays in Python
                continue
            kind = getattr(planefold, "".join(word.capitalize() for word in name[3:-2].split("_")))
            declared = re.findall(r"^  (?:int32_t|uint32_t|int64_t|double|uint8_t|size_t|pf_\w+) ([^;(]*);", body, re.M)
            for field in ",".join(declared).split(","):
                self.assertTrue(hasattr(kind, re.match(r"\s*(\w*)", field).group(1)), f"{name}: {field}")
        values = {str(value) for kind in vars(planefold).values() if isinstance(kind, type) and issubclass(kind, int) for value in kind}
        for value in re.findall(r"^\s*PF_(ERROR|NOTE)_(\w+) = ", text, re.M):
            self.assertIn("Status." + "_".join(value), values)

    def test_version_is_that_of_the_project(self):
        project = re.search(r"project\(planefold VERSION (\S+)", (script.SOURCE / "CMakeLists.txt").read_text()).group(1)
        self.assertEqual(planefold.__version__, project)


class Structures(unittest.TestCase):
    def test_arrays_are_views_and_matrices_have_their_shape(self):
        config = planefold.Config()
        config.camera.distortion[1] = 0.25
        self.assertEqual(config.camera.distortion[1], 0.25)
        self.assertEqual(config.copy().camera.distortion[1], 0.25)
        self.assertEqual(planefold.Pose().covariance.shape, (6, 6))
        self.assertEqual(planefold.Plane().R_WP.shape, (3, 3))
        view = planefold.Pose(p_WC=[1, 2, 3]).p_WC  # keeps its structure alive
        part = planefold.Config(camera=planefold.Camera(fx=300.0)).camera
        gc.collect()
        others = [planefold.Config() for _ in range(50)]
        self.assertEqual((list(view), part.fx, len(others)), ([1, 2, 3], 300.0, 50))

    def test_a_part_of_a_structure_is_no_copy(self):
        config = planefold.Config()
        capacity = config.capacity
        capacity.max_features = 50
        self.assertEqual(config.capacity.max_features, 50)
        self.assertIn("max_features=50", repr(config.capacity))

    def test_short_lists_leave_zeros_where_the_header_does(self):
        camera = planefold.Camera(distortion=[0.1, 0.2])
        self.assertEqual(list(camera.distortion), [0.1, 0.2, 0, 0, 0, 0, 0, 0])

    def test_classes_may_be_derived_from(self):
        class Lens(planefold.Camera):
            pass

        lens = Lens(fx=300.0)
        lens.fy = 310.0
        self.assertEqual((planefold.Config(camera=lens).camera.fy, lens.copy().fx), (310.0, 300.0))
        for wrong in (planefold.Camera.__new__(planefold.Camera), planefold.Pose(), 3):
            with self.assertRaisesRegex(TypeError, "this is no planefold.Camera"):
                planefold.Camera.fx.fget(wrong)

    def test_kinds_are_enums(self):
        config = planefold.Config()
        self.assertIs(config.motion.model, planefold.MotionModel.CONSTANT_VELOCITY)
        config.motion.model = planefold.MotionModel.INERTIAL
        self.assertEqual(config.motion.model, 4)

    def test_what_does_not_fit_is_refused_in_one_line(self):
        config = planefold.Config()
        for wrong, line in ((lambda: setattr(config.capacity, "max_features", 2.5), "ConfigCapacity.max_features: takes a whole number"),
                            (lambda: setattr(config.camera, "distortion", np.ones(9)), "takes at most 8 numbers, and was given 9"),
                            (lambda: planefold.Pose(p_WC=[1, 2]), "Pose.p_WC: takes 3 numbers, and was given 2"),
                            (lambda: planefold.Pose(p_CW=[1, 2, 3]), "Pose has no field p_CW"),
                            (lambda: setattr(config, "camera", planefold.Pose()), "Config.camera: takes a planefold.Camera, and not a Pose"),
                            (lambda: setattr(config, "camra", 1), "no attribute 'camra'")):
            with self.assertRaises((TypeError, ValueError, AttributeError)) as raised:
                wrong()
            self.assertIn(line, str(raised.exception))
            self.assertNotIn("\n", str(raised.exception))


if __name__ == "__main__":
    unittest.main(verbosity=2)
