// The lists of children that blocks keep: the same as a search through all blocks, by ascending owner, after every operation.
#include <algorithm>

#include "same.h"
#include "support/plane_scene.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

/// Every block's list against a search for the blocks that name it as their parent.
void check_lists(const State& state) {
  for (int s = 0; s < state.slots; ++s) {
    if (state.block[s].kind == BlockKind::kNone) continue;
    std::vector<int> found, listed;
    for (int t = 0; t < state.slots; ++t)
      if (state.block[t].kind != BlockKind::kNone && (state.block[t].parent == s || state.block[t].second_parent == s))
        found.push_back(t);
    for (int c = state.block[s].first_child; c >= 0; c = state.next_child(s, c)) listed.push_back(c);
    TEST_ASSERT_EQUAL_size_t(found.size(), listed.size());
    TEST_ASSERT_EQUAL_INT(state.block[s].children, static_cast<int>(listed.size()));
    for (std::size_t i = 1; i < listed.size(); ++i)
      TEST_ASSERT_TRUE(state.block[listed[i - 1]].owner <= state.block[listed[i]].owner);
    std::sort(listed.begin(), listed.end());
    TEST_ASSERT_SAME(found, listed);
  }
}

/// The features on a plane, as a walk through a table of features in its order finds them.
std::vector<int> searched(const State& state, int plane, int owners) {
  std::vector<int> slots;
  for (int owner = 0; owner < owners; ++owner)
    for (int s = 0; s < state.slots; ++s)
      if (state.block[s].owner == owner && is_planar(state.block[s].kind) && state.plane_of(s) == plane)
        slots.push_back(s);
  return slots;
}

std::vector<int> walked(const State& state, int plane) {
  std::vector<int> slots;
  state.for_each_planar(plane, [&](int slot) { slots.push_back(slot); });
  return slots;
}

/// A wall whose points belong to entries 0 .. 7 of a table, in an order of chance, and a second wall with the next five.
struct OwnedScene : PlaneScene {
  static constexpr int kOwners = 13;

  explicit OwnedScene(SeededRandom& random) : PlaneScene(random, 0.01) {
    std::vector<int> owner;
    for (int i = 0; i < kOwners; ++i) owner.push_back(i);
    for (int i = kOwners - 1; i > 0; --i)
      std::swap(owner[static_cast<std::size_t>(i)],
                owner[static_cast<std::size_t>(std::min(i, static_cast<int>(random.uniform(0, i + 1))))]);
    std::size_t next = 0;
    for (const std::vector<int>* wall : {&on_wall, &second_wall})
      for (const int s : *wall) filter->set_owner(s, owner[next++]);
  }
  void check() {
    const State& state = filter->state();
    check_lists(state);
    for (const int p : {plane, other_plane})
      if (p >= 0) TEST_ASSERT_SAME(searched(state, p, kOwners), walked(state, p));
  }
};

void test_lists_should_be_what_a_search_finds_after_every_operation() {
  SeededRandom random(401);
  for (int trial = 0; trial < 20; ++trial) {
    OwnedScene scene(random);
    scene.check();
    scene.fold_all(PlaneScene::drop());
    scene.add_second(PlaneScene::drop());
    scene.check();
    const int* wall = scene.on_wall.data();
    TEST_ASSERT_TRUE(scene.filter->fix(wall, 4, trial % 2 == 0 ? FixForm::kConsider : FixForm::kInflate, wall, 8));
    scene.check();
    TEST_ASSERT_TRUE(scene.filter->release(wall[trial % 4]));
    scene.check();
    TEST_ASSERT_TRUE(scene.filter->unfold(wall[(trial + 1) % 4], Scalar(0)));
    TEST_ASSERT_TRUE(scene.filter->unfold(wall[6], Scalar(0)));
    scene.check();
    unsigned char folded[Filter::kMaxFolded];
    scene.filter->fold(scene.plane, scene.second_wall.data(), 5, PlaneScene::drop(), folded);
    scene.filter->remove(&scene.other_plane, 1);
    scene.other_plane = -1;
    scene.check();
    scene.filter->remove(wall + 2, 3);
    check_lists(scene.filter->state());
  }
}

void test_lists_of_anchors_should_follow_owners_that_are_set_later() {
  SeededRandom random(402);
  TestFilter filter(true);
  const std::vector<int> slots = fill_map(random, filter, 2, 8);
  for (std::size_t i = 2; i < slots.size(); ++i) filter->set_owner(slots[i], static_cast<int>((i * 5) % 11));
  check_lists(filter->state());
  filter->convert_to_point(slots[4]);
  filter->remove(&slots[7], 1);
  check_lists(filter->state());
}

void test_every_feature_should_be_visited_when_each_is_unfolded_on_the_way() {
  SeededRandom random(403);
  OwnedScene scene(random);
  scene.fold_all(PlaneScene::drop());
  const int* wall = scene.on_wall.data();
  TEST_ASSERT_TRUE(scene.filter->fix(wall + 1, 4, FixForm::kConsider, wall, 8));
  const std::vector<int> expected = walked(scene.filter->state(), scene.plane);
  std::vector<int> visited;
  scene.filter->state().for_each_planar(scene.plane, [&](int slot) {
    visited.push_back(slot);
    TEST_ASSERT_TRUE(scene.filter->unfold(slot, Scalar(0)));
  });
  TEST_ASSERT_EQUAL_size_t(8, visited.size());
  TEST_ASSERT_SAME(expected, visited);
  check_lists(scene.filter->state());
}

/// Points of a plane, some of which depend on a second block; their two lists are in the order of owners, whatever comes first.
void test_a_block_should_stand_in_the_lists_of_both_its_parents() {
  SeededRandom random(404);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<Block> blocks(16);
    State state;
    state.block = blocks.data();
    state.slots = 16;
    for (int s = 0; s < 14; ++s) {
      blocks[static_cast<std::size_t>(s)].kind = s < 2 ? BlockKind::kPlane : BlockKind::kPlanePoint;
      blocks[static_cast<std::size_t>(s)].owner = static_cast<std::int16_t>(random.uniform(0, 6));
    }
    for (int s = 2; s < 14; ++s) {
      if (s % 3 != 0) state.adopt(s % 2, s);
      if (s % 4 != 0) state.adopt_as_second(1 - s % 2, s);
    }
    check_lists(state);
    for (int s = 2; s < 14; s += 3) state.set_owner(s, static_cast<int>(random.uniform(0, 6)));
    check_lists(state);
    for (int s = 2; s < 14; ++s) {
      const int second = state.block[s].second_parent;
      if (s % 5 == 0) state.leave_second_parent(s);
      if (s % 5 == 1) {
        state.leave_parent(s);
        TEST_ASSERT_EQUAL_INT(second, state.block[s].second_parent);
      }
      check_lists(state);
    }
  }
}

}  // namespace

int main(void) {
  UNITY_BEGIN();
  RUN_TEST(test_lists_should_be_what_a_search_finds_after_every_operation);
  RUN_TEST(test_lists_of_anchors_should_follow_owners_that_are_set_later);
  RUN_TEST(test_a_block_should_stand_in_the_lists_of_both_its_parents);
  RUN_TEST(test_every_feature_should_be_visited_when_each_is_unfolded_on_the_way);
  return UNITY_END();
}
