// Which programs the preloaded library fits, and how it refuses the others.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "roscpp_shim/machine/fit.h"

using namespace move_base_abstract::shim;

namespace {

/** Built with roscpp 1.15.15; see CMakeLists.txt. */
Surroundings good() {
  Surroundings found;
  found.glibc = "2.36";
  found.roscpp = {"/usr/lib/libroscpp.so.4d"};
  found.roscpp_version = "1.15.11";
  found.has_owners = true;
  found.has_clocks = true;
  return found;
}

void expectRefusal(const Surroundings& found, const std::string& why) {
  const std::string said = misfit(found);
  EXPECT_EQ(said.rfind(why, 0), 0U) << said;
  EXPECT_NE(said.find("this library fits roscpp 1.15 (built with 1.15.15) and glibc 2.30 or newer"),
            std::string::npos)
      << said;
}

}  // namespace

TEST(ShimFit, takesWhatItWasBuiltFor) {
  EXPECT_EQ(misfit(good()), "");
  Surroundings found = good();
  found.roscpp_version = "";  // not known: the functions are there
  EXPECT_EQ(misfit(found), "");
  found.glibc = "2.30";
  EXPECT_EQ(misfit(found), "");
  found.glibc = "3.0";
  EXPECT_EQ(misfit(found), "");
}

TEST(ShimFit, refusesAnotherGlibc) {
  Surroundings found = good();
  found.glibc = "2.28";
  expectRefusal(found, "the program's glibc is 2.28;");
}

TEST(ShimFit, refusesAnotherRoscpp) {
  for (const char* version : {"1.14.13", "1.16.0", "2.15.0", "1.18.0"}) {
    Surroundings found = good();
    found.roscpp_version = version;
    expectRefusal(found, std::string("the program's roscpp is ") + version + ";");
  }
}

TEST(ShimFit, refusesASecondRoscpp) {
  Surroundings found = good();
  found.roscpp.push_back("/opt/ros/lib/libroscpp.so");
  expectRefusal(found,
                "the program has another roscpp than this library was built for: "
                "/usr/lib/libroscpp.so.4d, /opt/ros/lib/libroscpp.so;");
}

TEST(ShimFit, namesFunctionsThatAreMissing) {
  Surroundings found = good();
  found.missing = {"ros::start() (roscpp)", "nanosleep() (libc)"};
  expectRefusal(found,
                "the program's libraries have no ros::start() (roscpp), nanosleep() (libc);");
}

TEST(ShimFit, refusesLocksAndConditionsThatKeepToThemselves) {
  Surroundings found = good();
  found.has_owners = false;
  expectRefusal(found, "the locks of glibc 2.36 do not name their holder;");
  found.has_owners = true;
  found.has_clocks = false;
  expectRefusal(found, "the conditions of glibc 2.36 do not name their clock;");
}

TEST(ShimFit, looksAroundInThisProgramWhichHasNoRos) {
  const Surroundings found = lookAround();
  EXPECT_TRUE(found.has_owners);
  EXPECT_TRUE(found.has_clocks);
  EXPECT_TRUE(found.roscpp.empty());
  EXPECT_EQ(found.missing.size(), 52U);  // all but libc's
  EXPECT_EQ(found.missing.front(), "ros::init(int&, char**, string const&, unsigned) (roscpp)");
}

TEST(ShimFit, knowsAVersionByTheNameOfTheFileOrByItsPackage) {
  namespace fs = std::filesystem;
  std::string name = testing::TempDir() + "shim_fit_XXXXXX";
  ASSERT_NE(mkdtemp(name.data()), nullptr);
  const fs::path folder = name;
  fs::create_directories(folder / "lib");
  fs::create_directories(folder / "share" / "roscpp");
  std::ofstream(folder / "lib" / "libroscpp.so.1.15.15") << "";
  fs::create_symlink("libroscpp.so.1.15.15", folder / "lib" / "libroscpp.so.4d");
  EXPECT_EQ(versionOf(folder / "lib" / "libroscpp.so.4d", "roscpp"), "1.15.15");
  std::ofstream(folder / "lib" / "libroscpp.so") << "";
  EXPECT_EQ(versionOf(folder / "lib" / "libroscpp.so", "roscpp"), "");
  std::ofstream(folder / "share" / "roscpp" / "package.xml")
      << "<package>\n  <name>roscpp</name>\n  <version>1.16.0</version>\n</package>\n";
  EXPECT_EQ(versionOf(folder / "lib" / "libroscpp.so", "roscpp"), "1.16.0");
  EXPECT_EQ(versionOf("/no/such/libroscpp.so", "roscpp"), "");
  fs::remove_all(folder);
}

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
