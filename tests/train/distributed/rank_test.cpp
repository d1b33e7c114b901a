// What launchers say through the environment.
#include "train/distributed/rank.h"

#include <cstdlib>
#include <map>
#include <string>

#include "tests/train/support.h"

namespace lte::train {
namespace {

/// Sets variables while it lives, and takes away all others that a launcher sets.
class Environment {
 public:
  explicit Environment(const std::map<std::string, std::string>& variables) {
    clear();
    for (const auto& [name, value] : variables) setenv(name.c_str(), value.c_str(), 1);
  }
  ~Environment() { clear(); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  static void clear() {
    for (const char* name :
         {"RANK", "WORLD_SIZE", "LOCAL_RANK", "MASTER_ADDR", "MASTER_PORT", "OMPI_COMM_WORLD_RANK",
          "OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_LOCAL_RANK", "PMI_RANK", "PMI_SIZE",
          "MPI_LOCALRANKID", "SLURM_PROCID", "SLURM_NTASKS", "SLURM_LOCALID"}) {
      unsetenv(name);
    }
  }
};

void expect_rank(const std::map<std::string, std::string>& variables, int index, int count,
                 int local) {
  const Environment environment(variables);
  const Rank rank = rank_from_environment();
  EXPECT_EQ(rank.index, index);
  EXPECT_EQ(rank.count, count);
  EXPECT_EQ(rank.local, local);
}

TEST(Rank, IsOneProcessUnlessALauncherSaysOtherwise) { expect_rank({}, 0, 1, 0); }

TEST(Rank, IsReadFromTorchrun) {
  const Environment environment({{"RANK", "5"},
                                 {"WORLD_SIZE", "8"},
                                 {"LOCAL_RANK", "1"},
                                 {"MASTER_ADDR", "gpu0"},
                                 {"MASTER_PORT", "29511"}});
  const Rank rank = rank_from_environment();
  EXPECT_EQ(rank.index, 5);
  EXPECT_EQ(rank.count, 8);
  EXPECT_EQ(rank.local, 1);
  EXPECT_EQ(rank.address, "gpu0");
  EXPECT_EQ(rank.port, 29511);
  EXPECT_FALSE(rank.leads());
}

TEST(Rank, IsReadFromMpirunAndSrunWhereAMasterIsNamed) {
  expect_rank({{"MASTER_ADDR", "a"},
               {"OMPI_COMM_WORLD_RANK", "2"},
               {"OMPI_COMM_WORLD_SIZE", "3"},
               {"OMPI_COMM_WORLD_LOCAL_RANK", "0"}},
              2, 3, 0);
  expect_rank({{"MASTER_ADDR", "a"}, {"PMI_RANK", "1"}, {"PMI_SIZE", "2"}}, 1, 2, 1);
  const std::map<std::string, std::string> slurm = {
      {"SLURM_PROCID", "3"}, {"SLURM_NTASKS", "4"}, {"SLURM_LOCALID", "1"}};
  expect_rank(slurm, 0, 1, 0);  // a batch script, not a step with a meeting place
  auto step = slurm;
  step.emplace("MASTER_ADDR", "a");
  expect_rank(step, 3, 4, 1);
}

TEST(Rank, NamesTheVariableThatIsWrong) {
  const auto refuse = [](const std::map<std::string, std::string>& variables,
                         const std::vector<std::string>& parts) {
    const Environment environment(variables);
    test::expect_error([] { rank_from_environment(); }, parts);
  };
  refuse({{"RANK", "0"}}, {"RANK", "WORLD_SIZE"});
  refuse({{"WORLD_SIZE", "2"}}, {"WORLD_SIZE", "RANK"});
  refuse({{"RANK", "2"}, {"WORLD_SIZE", "2"}}, {"RANK=2", "0 to 1"});
  refuse({{"RANK", "one"}, {"WORLD_SIZE", "2"}}, {"RANK=one"});
  refuse({{"RANK", "0"}, {"WORLD_SIZE", "0"}}, {"WORLD_SIZE=0"});
  refuse({{"RANK", "0"}, {"WORLD_SIZE", "2"}, {"MASTER_PORT", "70000"}}, {"MASTER_PORT=70000"});
}

}  // namespace
}  // namespace lte::train
