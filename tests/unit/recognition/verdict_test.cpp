// A verdict must follow each sign in the direction that its reason gives, whatever the fit says: a
// wrong sign of a weight is a fit to chance.
#include "services/recognition/core/detection/verdict.hpp"

#include <gtest/gtest.h>

namespace prehend::recognition {
namespace {

const Signs good{.by_colours = 0.6, .agreement = 0.7, .contrast = 0.85, .hidden = 0.2};

TEST(Verdict, EachSignCountsInItsDirection) {
  const double middle = verdict(good);
  EXPECT_GT(middle, 0);
  EXPECT_LT(middle, 1);
  const auto with = [&](auto change) {
    Signs made = good;
    change(made);
    return verdict(made);
  };
  EXPECT_GT(with([](Signs& s) { s.by_colours = 0.8; }), middle);
  EXPECT_GT(with([](Signs& s) { s.agreement = 0.9; }), middle);
  EXPECT_GT(with([](Signs& s) { s.contrast = 0.95; }), middle);
  EXPECT_GT(with([](Signs& s) { s.hidden = 0; }), middle);
  EXPECT_LT(with([](Signs& s) { s.measured = {1.1, 1}; }), middle);
  EXPECT_LT(with([](Signs& s) { s.measured = {1, 0.9}; }), middle);
}

TEST(Verdict, WhatShowsNoOutlineIsNothing) {
  Signs faint = good;
  faint.by_colours = 1;
  faint.agreement = 0.3;
  faint.contrast = 1;
  EXPECT_EQ(verdict(faint), 0);
  faint.agreement = 0.6;
  faint.contrast = 0.5;
  EXPECT_EQ(verdict(faint), 0);
}

}  // namespace
}  // namespace prehend::recognition
