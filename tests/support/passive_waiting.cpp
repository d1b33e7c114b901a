// Linked into every test program: its OpenMP threads wait as those of the tools do.
#include "lte/base/passive_waiting.h"

#include <gtest/gtest.h>

namespace lte::test {
namespace {

class PassiveThreads : public ::testing::Environment {
  void SetUp() override { wait_passively(); }
};
const ::testing::Environment* const kPassiveThreads =
    ::testing::AddGlobalTestEnvironment(new PassiveThreads);  // owned by GoogleTest

}  // namespace
}  // namespace lte::test
