// The nodes of the tests are roles of one program: its compiler reads the headers of ROS once. Each
// role is a hard link to the program, and the name by which it is started tells which one it is.
// ROLES, by CMake: ROLE(name) for each. Its source has namespace name { int nodeMain(...) }.
#include <cstdio>
#include <cstring>

#define ROLE(name)                     \
  namespace name {                     \
  int nodeMain(int argc, char** argv); \
  }
ROLES
#undef ROLE

namespace {

struct Role {
  const char* name;
  int (*run)(int argc, char** argv);
};

#define ROLE(name) {#name, &name::nodeMain},
constexpr Role kRoles[] = {ROLES};
#undef ROLE

}  // namespace

int main(int argc, char** argv) {
  const char* const slash = std::strrchr(argv[0], '/');
  const char* const name = slash == nullptr ? argv[0] : slash + 1;
  for (const Role& role : kRoles) {
    if (std::strcmp(role.name, name) == 0) {
      return role.run(argc, argv);
    }
  }
  std::fprintf(stderr, "%s: no role is called '%s'; there are:", argv[0], name);
  for (const Role& role : kRoles) {
    std::fprintf(stderr, " %s", role.name);
  }
  std::fprintf(stderr, "\n");
  return 2;
}
