// Replaces functions of rosconsole, whose data is shared with roscpp's own threads, which log, too.
#include <ros/console.h>

#include <string>

#include "roscpp_shim/machine/real.h"
#include "roscpp_shim/turn.h"

namespace shim = move_base_abstract::shim;

namespace ros::console {

ROSCONSOLE_DECL void initializeLogLocation(LogLocation* location, const std::string& name,
                                           Level level) {
  static auto* const function = shim::real(
      &initializeLogLocation,
      "_ZN3ros7console21initializeLogLocationEPNS0_11LogLocationERKNSt7__cxx1112basic_stringIcSt11"
      "char_traitsIcESaIcEEENS0_6levels5LevelE");
  const shim::Beside beside;
  function(location, name, level);
}

namespace impl {

ROSCONSOLE_DECL void print(void* handle, Level level, const char* text, const char* file,
                           const char* caller, int line) {
  static auto* const function =
      shim::real(&print, "_ZN3ros7console4impl5printEPvNS0_6levels5LevelEPKcS6_S6_i");
  const shim::Beside beside;
  function(handle, level, text, file, caller, line);
}

}  // namespace impl

}  // namespace ros::console
