// Tests of mutually exclusive places.
#include "identification/structural/damage/findings/rival_places.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace wheeltap::identification {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// n places with these probabilities, mutually exclusive except as in `also`.
PlaceProbabilities exclusive(std::vector<double> each) {
  const std::size_t n = each.size();
  return {std::move(each), std::vector(n, std::vector<double>(n))};
}

void together(PlaceProbabilities& places, std::size_t a, std::size_t b, double p) {
  places.both[a][b] = places.both[b][a] = p;
}

TEST(RivalPlaces, PlacesThatExcludeEachOtherAreAGroup) {
  EXPECT_THAT(exclusive_groups(exclusive({0.44, 0.0, 0.56})), ElementsAre(ElementsAre(2, 0)));
  auto nearly = exclusive({0.44, 0.01, 0.56});
  together(nearly, 0, 2, 0.04);  // a tenth of the less probable
  EXPECT_THAT(exclusive_groups(nearly), ElementsAre(ElementsAre(2, 0)));
}

TEST(RivalPlaces, DamagesThatOccurTogetherAreNoRivals) {
  auto both = exclusive({0.9, 0.0, 0.95});
  together(both, 0, 2, 0.86);
  EXPECT_THAT(exclusive_groups(both), IsEmpty());
  // Independent places are not a group.
  auto independent = exclusive({0.5, 0.5});
  together(independent, 0, 1, 0.25);
  EXPECT_THAT(exclusive_groups(independent), IsEmpty());
}

TEST(RivalPlaces, OmitsCertainAndImprobablePlaces) {
  EXPECT_THAT(exclusive_groups(exclusive({0.96, 0.04})), IsEmpty());  // one place, below 5 %
  EXPECT_THAT(exclusive_groups(exclusive({0.2, 0.2})), IsEmpty());    // no damage is more probable
}

// Two damages, each at one of two places.
TEST(RivalPlaces, TwoDamagesAreTwoGroups) {
  auto two = exclusive({0.7, 0.6, 0.4, 0.3});
  together(two, 0, 1, 0.42), together(two, 0, 2, 0.28);
  together(two, 3, 1, 0.18), together(two, 3, 2, 0.12);
  EXPECT_THAT(exclusive_groups(two), ElementsAre(ElementsAre(0, 3), ElementsAre(1, 2)));
}

}  // namespace
}  // namespace wheeltap::identification
