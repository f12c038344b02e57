"""The tables of the Python bindings follow the headers: what is renamed, added or moved there needs no line elsewhere."""

import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

sys.path.insert(0, str(script.SOURCE / "tools/python"))
sys.dont_write_bytecode = True
import header_reader  # noqa: E402
import tables_from_headers  # noqa: E402

HEADER = """/* A page about the file; it is of nothing in particular. */
#ifndef PF_THING_H
#define PF_THING_H

#define PF_THING_MAX 12 /* things */
#define PF_THING_BOTH ((PF_THING_MAX << 16) | 1)

/* ------------------------------------------------------------------------------------------------- things -- */

typedef enum pf_thing_kind {
  PF_THING_SMALL = 1, /* fits
                       * anywhere */
  /* Does not. */
  PF_THING_LARGE = 2
} pf_thing_kind_t;

enum { PF_THING_WAITING = 5, PF_THING_COUNT = 6 };

typedef enum pf_thing_way {
  PF_THING_OVER =
      /* the long one, which
       * takes its time
       * */
  1,
  PF_THING_UNDER = 2 /* the short one */
} pf_thing_way_t;

typedef struct pf_other pf_other_t; /* nobody sees inside */

/* A thing,
 * in two lines. */
typedef struct pf_thing {
  int32_t kind;   /* pf_thing_kind_t */
  int32_t state;  /* pf_thing_kind_t, or PF_THING_WAITING */
  double a, b[3]; /* both of them */
  /* Inside. */
  struct {
    int32_t depth; /* of it */
  } inner;
  double points[PF_THING_MAX][2 * 3];
  int64_t (*clock_ns)(void* user); /* not of Python */
  void* user;
  const pf_other_t*
      /* which may
       * be long */
      other;
  int32_t
      /* at last */
      last;
} pf_thing_t;

/* Does it; not with b[1], 2 or (3). */
PF_API pf_status_t pf_do_thing(const pf_thing_t* thing,
                               double out[3]);
PF_API pf_status_t pf_undo(pf_thing_t* thing);

#endif
"""


class Tables(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        (self.folder / "thing.h").write_text(HEADER)
        self.items = {(item.kind, item.name): item for item in header_reader.read(self.folder / "thing.h")}

    def test_each_thing_has_its_own_comment(self):
        self.assertEqual(self.items["struct", "pf_thing_t"].comment, "A thing,\nin two lines.")
        self.assertEqual(self.items["function", "pf_do_thing"].comment, "Does it; not with b[1], 2 or (3).")
        self.assertEqual(self.items["function", "pf_undo"].comment, "")
        kind = self.items["enum", "pf_thing_kind_t"]
        self.assertEqual([(value.name, value.comment) for value in kind.members],
                         [("PF_THING_SMALL", "fits\nanywhere"), ("PF_THING_LARGE", "Does not.")])
        way = self.items["enum", "pf_thing_way_t"]
        self.assertEqual([(value.name, value.comment) for value in way.members],
                         [("PF_THING_OVER", "the long one, which\ntakes its time"), ("PF_THING_UNDER", "the short one")])
        self.assertEqual([value.name for value in self.items["enum", ""].members], ["PF_THING_WAITING", "PF_THING_COUNT"])
        self.assertEqual([name for kind, name in self.items if kind == "constant"], ["PF_THING_MAX"])

    def test_fields_are_those_of_the_structure(self):
        fields = self.items["struct", "pf_thing_t"].members
        self.assertEqual([field.name for field in fields], ["kind", "state", "a", "b", "inner", "points", "last"])
        self.assertEqual([field.comment for field in fields], ["pf_thing_kind_t", "pf_thing_kind_t, or PF_THING_WAITING", "both of them",
                                                               "both of them", "Inside.", "", "at last"])
        self.assertEqual(fields[4].members[0].comment, "of it")

    def test_a_field_is_of_an_enum_that_its_comment_begins_with(self):
        enums = {"pf_thing_kind_t"}
        for comment, enum in (("pf_thing_kind_t", '"ThingKind"'), ("Heading.\n\npf_thing_kind_t. Default small", '"ThingKind"'),
                              ("pf_thing_kind_t, or PF_THING_WAITING", "nullptr"), ("as pf_thing_kind_t", "nullptr"),
                              ("pf_thing_t.kind", "nullptr")):
            self.assertEqual(tables_from_headers.enum_of(comment, enums), enum)

    def test_a_file_whose_text_stays_the_same_is_not_written(self):
        out = self.folder / "out"
        out.mkdir()
        for _ in range(2):
            tables_from_headers.main(out, self.folder / "thing.h")
            times = [path.stat().st_mtime_ns for path in sorted(out.iterdir())]
        tables_from_headers.main(out, self.folder / "thing.h")
        self.assertEqual([path.stat().st_mtime_ns for path in sorted(out.iterdir())], times)
        text = (out / "tables.cpp").read_text()
        for words in ('record.add<decltype(pf_thing_t::points)>("points", offsetof(pf_thing_t, points)', "Record<pf_thing_t_inner>",
                      '.value("LARGE", PF_THING_LARGE', 'module.attr("THING_COUNT")'):
            self.assertIn(words, text)
        self.assertIn("pf_do_thing[] = ", (out / "docs.h").read_text())


if __name__ == "__main__":
    unittest.main(verbosity=2)
