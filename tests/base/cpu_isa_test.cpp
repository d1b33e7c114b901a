#include "lte/base/cpu_isa.h"

#include <cstdlib>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lte/base/check.h"

namespace lte {
namespace {

/// Sets LTE_CPU_ISA, or nothing at all, for one test.
class Wanted {
 public:
  explicit Wanted(const char* isa) {
    if (const char* before = std::getenv("LTE_CPU_ISA"); before != nullptr) before_ = before;
    isa == nullptr ? unsetenv("LTE_CPU_ISA") : setenv("LTE_CPU_ISA", isa, 1);
  }
  ~Wanted() { before_ ? setenv("LTE_CPU_ISA", before_->c_str(), 1) : unsetenv("LTE_CPU_ISA"); }
  Wanted(const Wanted&) = delete;
  Wanted& operator=(const Wanted&) = delete;

 private:
  std::optional<std::string> before_;
};

TEST(CpuIsa, IsWhatTheEnvironmentSays) {
  for (const char* isa : {"baseline", "avx2", "avx512", "avx512_bf16", "amx"}) {
    const Wanted wanted(isa);
    EXPECT_EQ(wanted_cpu_isa(), isa);
  }
  const Wanted nothing(nullptr);
  EXPECT_EQ(wanted_cpu_isa(), "");
}

TEST(CpuIsa, NamesWhatItDoesNotKnow) {
  const Wanted wanted("avx");
  try {
    (void)wanted_cpu_isa();
    FAIL() << "avx is none of them";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("LTE_CPU_ISA"));
    EXPECT_THAT(error.what(), testing::HasSubstr("got avx"));
  }
}

}  // namespace
}  // namespace lte
