// Whether the inliers of a pose are neighbours among all that was searched for.
#include "frame/pose_hypotheses.h"
#include "support/textured_images.h"
#include "unity.h"

using namespace pf;

void setUp(void) {}
void tearDown(void) {}

namespace {

constexpr int kSide = 6;

/// A grid of searched features, a little irregular, so that each has one nearest neighbour.
class Searched {
 public:
  Searched() {
    TEST_ASSERT_TRUE(frame_.layout(*arena_, kSide * kSide));
    for (int i = 0; i < kSide * kSide; ++i) {
      const int x = i % kSide, y = i / kSide;
      const Vec2 at(static_cast<Scalar>(20 * x + (x % 2 == 0 ? 4 : 0)), static_cast<Scalar>(30 * y));
      frame_.add(
          {i, 0, MatchStatus::kMissed, BlockKind::kPoint, true, false, at, Mat2::Zero(), Vec2::Zero(), Scalar(0)});
    }
  }
  Frame& frame() { return frame_; }
  Match& at(int x, int y) { return frame_.match(kSide * y + x); }

 private:
  TestArena arena_;
  Frame frame_;
};

void test_inliers_of_one_part_should_be_paired() {
  Searched searched;
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 4; ++x) searched.at(x, y).agrees = true;
  TEST_ASSERT_EQUAL_INT(12, paired_inliers(searched.frame()));
}

void test_scattered_inliers_should_not_be_paired() {
  Searched searched;
  for (int y = 0; y < kSide; ++y)
    for (int x = y % 2 == 0 ? 0 : 3; x < kSide; x += 4) searched.at(x, y).agrees = true;
  TEST_ASSERT_EQUAL_INT(0, paired_inliers(searched.frame()));
  searched.frame().forget_agreement();
  TEST_ASSERT_FALSE(searched.at(0, 0).agrees);
}

/// What was not searched for is no neighbour.
void test_features_that_were_not_searched_for_should_not_count() {
  Searched searched;
  searched.at(0, 0).agrees = searched.at(2, 0).agrees = true;
  TEST_ASSERT_EQUAL_INT(0, paired_inliers(searched.frame()));
  for (int t = 0; t < searched.frame().match_count(); ++t) {
    Match& match = searched.frame().match(t);
    match.searched = match.agrees;
  }
  TEST_ASSERT_EQUAL_INT(2, paired_inliers(searched.frame()));
}

/// They are counted where fewer are found than before.
void test_pairs_should_be_counted_where_few_are_found() {
  Searched searched;
  FindShare share;
  share.init();
  for (int frame = 0; frame < 20; ++frame) share.learn(100, 90);
  for (int x = 0; x < 4; ++x) searched.at(x, 0).agrees = true;
  PoseConsensus consensus;
  consensus.searched = kSide * kSide;
  consensus.inliers = 4;
  note_paired(searched.frame(), share, &consensus);
  TEST_ASSERT_EQUAL_INT(4, consensus.paired);
  consensus.paired = -1;
  consensus.inliers = 35;
  note_paired(searched.frame(), share, &consensus);
  TEST_ASSERT_EQUAL_INT(-1, consensus.paired);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_inliers_of_one_part_should_be_paired);
  RUN_TEST(test_scattered_inliers_should_not_be_paired);
  RUN_TEST(test_features_that_were_not_searched_for_should_not_count);
  RUN_TEST(test_pairs_should_be_counted_where_few_are_found);
  return UNITY_END();
}
