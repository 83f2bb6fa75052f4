#include "shared_files.h"

#include <initializer_list>
#include <string_view>

#include "clock/number_text.h"
#include "clock/shown_text.h"

namespace move_base_abstract {
namespace {

/** @return the first of @p names that differs from @p name; '' if there is none. */
std::string otherThan(const std::string& name, const std::set<std::string>& names) {
  for (const std::string& one : names) {
    if (one != name) {
      return one;
    }
  }
  return "";
}

bool beginsWith(std::string_view text, std::initializer_list<std::string_view> beginnings) {
  for (const std::string_view beginning : beginnings) {
    if (text.substr(0, beginning.size()) == beginning) {
      return true;
    }
  }
  return false;
}

/** @return whether a file is the same in every run, or its use is reported in another way. */
bool isHarmless(std::string_view path) {
  constexpr std::string_view kMemory = "/dev/shm/";  // a folder like others
  const std::string_view name = path.substr(path.rfind('/') + 1);
  return (!beginsWith(path, {kMemory}) &&
          beginsWith(path, {"/usr/", "/lib/", "/lib32/", "/lib64/", "/etc/", "/opt/", "/proc/",
                            "/sys/", "/dev/"})) ||
         beginsWith(name, {"rospack_cache_", "rosstack_cache_"}) ||  // of where packages are
         path.find("/__pycache__/") != std::string_view::npos;
}

}  // namespace

std::string SharedFiles::add(const std::string& member, const wire::Note& note) {
  if (isHarmless(note.text)) {
    return "";
  }
  const bool writes = note.what == wire::NoteKind::kWrites;
  File& file = files_[std::string(note.text)];
  (writes ? file.writers : file.readers).insert(member);
  const std::string writer = otherThan(member, file.writers);
  const std::string other = writer.empty() && writes ? otherThan(member, file.readers) : writer;
  if (other.empty()) {
    return "";
  }
  return quote(member) + (writes ? " writes " : " reads ") + shown(note.text) + ", which " +
         quote(other) + (writer.empty() ? " reads" : " writes") +
         ": data that passes between them is not in the order of simulated time";
}

}  // namespace move_base_abstract
