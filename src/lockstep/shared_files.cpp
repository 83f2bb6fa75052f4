#include "shared_files.h"

#include "clock/number_text.h"
#include "clock/shown_text.h"

namespace move_base_abstract {
namespace {

/** @return the first of @p names that is another one than @p name; empty: there is none. */
std::string otherThan(const std::string& name, const std::set<std::string>& names) {
  for (const std::string& one : names) {
    if (one != name) {
      return one;
    }
  }
  return "";
}

}  // namespace

std::string SharedFiles::add(const std::string& member, const wire::Note& note) {
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
         ": what passes between them so is not in the order of simulated time";
}

}  // namespace move_base_abstract
