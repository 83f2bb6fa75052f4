#include <algorithm>
#include <sstream>

#include "parameters.h"

namespace move_base_abstract::shim {
namespace {

using Words = PendingParameters::Words;
using XmlRpc::XmlRpcValue;

Words wordsOf(const std::string& name) {
  Words words;
  std::istringstream text(name);
  for (std::string word; std::getline(text, word, '/');) {
    if (!word.empty()) {
      words.push_back(word);
    }
  }
  return words;
}

std::string nameOf(const Words& words) {
  std::string name;
  for (const std::string& word : words) {
    name += "/" + word;
  }
  return name.empty() ? "/" : name;
}

bool isBelow(const Words& words, const Words& above) {
  return words.size() >= above.size() && std::equal(above.begin(), above.end(), words.begin());
}

bool isTree(const XmlRpcValue& value) { return value.getType() == XmlRpcValue::TypeStruct; }

XmlRpcValue emptyTree() {
  int offset = 0;
  return XmlRpcValue("<value><struct></struct></value>", &offset);
}

void put(XmlRpcValue& tree, const Words& words, const XmlRpcValue& value) {
  XmlRpcValue* at = &tree;
  for (const std::string& word : words) {
    if (!isTree(*at)) {
      *at = emptyTree();
    }
    at = &(*at)[word];
  }
  *at = value;
}

/** @brief Remove a member. A struct of xmlrpcpp cannot lose one, so it is made anew. */
void drop(XmlRpcValue& tree, const Words& words) {
  XmlRpcValue* at = &tree;
  for (std::size_t k = 0; k + 1 < words.size(); ++k) {
    if (!isTree(*at) || !at->hasMember(words[k])) {
      return;
    }
    at = &(*at)[words[k]];
  }
  if (words.empty() || !isTree(*at) || !at->hasMember(words.back())) {
    return;
  }
  XmlRpcValue others = emptyTree();
  for (const auto& [word, value] : *at) {
    if (word != words.back()) {
      others[word] = value;
    }
  }
  *at = others;
}

XmlRpcValue take(const XmlRpcValue& tree, const Words& words) {
  const XmlRpcValue* at = &tree;
  for (const std::string& word : words) {
    if (!isTree(*at) || !at->hasMember(word)) {
      return {};
    }
    at = &(*at)[word];
  }
  return *at;
}

void addLeaves(const XmlRpcValue& value, const Words& words, std::vector<Words>* leaves) {
  if (!isTree(value)) {
    leaves->push_back(words);
    return;
  }
  for (const auto& [word, item] : value) {
    Words below = words;
    below.push_back(word);
    addLeaves(item, below, leaves);
  }
}

}  // namespace

void PendingParameters::set(const std::string& name, const XmlRpcValue& value) {
  changes_.push_back({wordsOf(name), value});
}

void PendingParameters::erase(const std::string& name) { changes_.push_back({wordsOf(name), {}}); }

bool PendingParameters::concern(const std::string& name) const {
  const Words words = wordsOf(name);
  return std::any_of(changes_.begin(), changes_.end(), [&words](const Change& change) {
    return isBelow(words, change.words) || isBelow(change.words, words);
  });
}

XmlRpcValue PendingParameters::seen(const std::string& name, const XmlRpcValue& current) const {
  const Words words = wordsOf(name);
  XmlRpcValue tree = emptyTree();
  if (current.valid()) {
    put(tree, words, current);
  }
  for (const Change& change : changes_) {
    if (change.value.valid()) {
      put(tree, change.words, change.value);
    } else {
      drop(tree, change.words);
    }
  }
  return take(tree, words);
}

std::vector<std::string> PendingParameters::names(const std::vector<std::string>& names) const {
  std::vector<Words> there;
  std::transform(names.begin(), names.end(), std::back_inserter(there), wordsOf);
  for (const Change& change : changes_) {
    const bool is_set = change.value.valid();
    there.erase(std::remove_if(there.begin(), there.end(),
                               [&](const Words& words) {
                                 return isBelow(words, change.words) ||
                                        (is_set && isBelow(change.words, words));
                               }),
                there.end());
    if (is_set) {
      addLeaves(change.value, change.words, &there);
    }
  }
  std::vector<std::string> after;
  std::transform(there.begin(), there.end(), std::back_inserter(after), nameOf);
  return after;
}

}  // namespace move_base_abstract::shim
