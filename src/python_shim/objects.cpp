// Python's objects that are made in turns lie at addresses that follow from the program, and its
// functions are hashed by name. No ROS. Python's headers are not needed: this library must go with
// every Python, so all that it takes for granted is checked when it begins.
#include <dlfcn.h>
#include <string.h>
#include <sys/auxv.h>

#include "arenas.h"
#include "run.h"

namespace move_base_abstract::native {
namespace {

struct Object;  // Python's PyObject
using Size = std::ptrdiff_t;

/** @brief Python's PyMemAllocatorEx. */
struct Allocator {
  void* context;
  void* (*allocate)(void* context, std::size_t size);
  void* (*allocateZeros)(void* context, std::size_t count, std::size_t size);
  void* (*resize)(void* context, void* address, std::size_t size);
  void (*release)(void* context, void* address);
};
constexpr int kObjects = 2;  // PYMEM_DOMAIN_OBJ

/** Where the parts of a type lie that are used here [bytes]. */
enum Slot : std::size_t {
  kDealloc = 48,
  kHash = 120,
  kBase = 256,
  kDict = 264,
  kAlloc = 304,
  kNew = 312
};

template <typename Value>
Value& slot(Object* type, Slot at) {
  return *reinterpret_cast<Value*>(reinterpret_cast<char*>(type) + at);
}

using Alloc = Object*(Object* type, Size items);
using New = Object*(Object* meta, Object* arguments, Object* words);
using Dealloc = void(Object* object);
using Hash = Size(Object* object);

/** @brief Functions and types of the Python in this process. */
struct Python {
  Alloc* genericAlloc;
  void (*getAllocator)(int domain, Allocator* allocator);
  void (*setAllocator)(int domain, Allocator* allocator);
  Object* (*qualNameOf)(Object* type);
  Object* (*itemOf)(Object* dict, const char* key);
  Object* (*attributeOf)(Object* object, const char* name);
  Object* (*moduleOf)(Object* function);
  const char* (*textOf)(Object* text);
  void (*clearError)();
  int (*isSubtype)(Object* type, Object* other);
  void (*drop)(Object* object);
  Hash* hashByAddress;
  Object* object;
  Object* type;
  Object* function;
};

Python python;
Allocator below;            // the allocator that was there before
New* makeType;              // type.__new__
Dealloc* deallocOfClasses;  // of all types that a class statement makes
Dealloc* deallocOfFunction;
Dealloc* deallocOfType;
const char* left_out = "";  // "\n" and a module, for each module whose types have no arenas; "\n"
Arenas arenas;
std::uint64_t salt = 0;                   // another one gives other addresses and hashes
Arena none;                               // stands for the arena of such a type
NumberTable<Arena*> arena_of;             // {type: its arenas}
NumberTable<std::uint64_t> hash_of;       // {function: its hash}
NumberTable<std::uint64_t> functions_of;  // {hash of a name: number of functions that were hashed}
thread_local Object* t_type __attribute__((tls_model("initial-exec"))) = nullptr;

std::uint64_t key(const void* address) { return reinterpret_cast<std::uintptr_t>(address); }

template <typename Function>
bool look(Function& into, const char* symbol) {
  into = reinterpret_cast<Function>(dlsym(RTLD_DEFAULT, symbol));
  return into != nullptr;
}

bool lookAll() {
  return look(python.genericAlloc, "PyType_GenericAlloc") &&
         look(python.getAllocator, "PyMem_GetAllocator") &&
         look(python.setAllocator, "PyMem_SetAllocator") &&
         look(python.qualNameOf, "PyType_GetQualName") &&
         look(python.itemOf, "PyDict_GetItemString") &&
         look(python.attributeOf, "PyObject_GetAttrString") &&
         look(python.moduleOf, "PyFunction_GetModule") && look(python.textOf, "PyUnicode_AsUTF8") &&
         look(python.clearError, "PyErr_Clear") && look(python.isSubtype, "PyType_IsSubtype") &&
         look(python.drop, "Py_DecRef") && look(python.hashByAddress, "_Py_HashPointer") &&
         look(python.object, "PyBaseObject_Type") && look(python.type, "PyType_Type") &&
         look(python.function, "PyFunction_Type");
}

/** @return a hash of a text (FNV-1a), going on from @p hash. */
std::uint64_t hashed(const char* text, std::uint64_t hash = 0xcbf29ce484222325) {
  for (; text != nullptr && *text != '\0'; ++text) {
    hash = (hash ^ static_cast<unsigned char>(*text)) * 0x100000001b3;
  }
  return hash;
}

/** @return the characters of a Python text; "" if it is none. */
const char* charactersOf(Object* text) {
  const char* const characters = text == nullptr ? nullptr : python.textOf(text);
  if (characters == nullptr) {
    python.clearError();
    return "";
  }
  return characters;
}

// ---- objects ---------------------------------------------------------------------------------

/** @return whether a module, or a package that it is in, is left out. */
bool isLeftOut(const char* module) {
  const auto isListed = [module](std::size_t size) {
    for (const char* at = strchr(left_out, '\n'); at != nullptr; at = strchr(at + 1, '\n')) {
      if (strncmp(at + 1, module, size) == 0 && at[1 + size] == '\n') {
        return true;
      }
    }
    return false;
  };
  bool is_listed = *module == '\0';  // a class that does not say where it is from
  for (std::size_t size = 0; !is_listed && size <= strlen(module); ++size) {
    is_listed = (module[size] == '.' || module[size] == '\0') && isListed(size);
  }
  return is_listed;
}

/** @return an arena for objects of this size of a type, which had none; null: there is none. */
Arena* arenaFor(Object* type, std::size_t size) {
  Object* const module = python.itemOf(slot<Object*>(type, kDict), "__module__");
  const char* const name = charactersOf(module);
  if (isLeftOut(name)) {
    return &none;
  }
  Object* const qual_name = python.qualNameOf(type);
  const std::uint64_t hash = hashed(charactersOf(qual_name), hashed(name) * 3);
  if (qual_name != nullptr) {
    python.drop(qual_name);
  }
  return arenas.open(hash, size);
}

void* allocateFor(Object* type, std::size_t size) {
  Arena** place = arena_of.find(key(type));
  Arena* arena = place == nullptr ? nullptr : *place;
  while (arena != nullptr && arena != &none && (arena->size < size || arena->size >= size + 16)) {
    arena = arena->other;
  }
  if (arena == nullptr) {
    arena = arenaFor(type, size);
    place = arena_of.find(key(type));
    if (arena == nullptr ||
        (place == nullptr && (place = arena_of.add(key(type), nullptr)) == nullptr)) {
      return nullptr;
    }
    arena->other = *place;
    *place = arena;
  }
  void* const object = arena == &none ? nullptr : arenas.allocate(arena, cell(kEpoch));
  if (arenas.trouble() != 0) {
    cells[kTrouble] = arenas.trouble();
  }
  return object;
}

/** @brief Leave the arenas of a type that is gone. */
void forget(const Object* type) {
  Arena** const place = arena_of.find(key(type));
  Arena* arena = place == nullptr ? nullptr : *place;
  arena_of.remove(key(type));
  while (arena != nullptr && arena != &none) {
    Arena* const other = arena->other;
    arenas.leave(arena);
    arena = other;
  }
}

/** @brief tp_alloc of the types that have arenas. */
Object* allocateInTurn(Object* type, Size items) {
  t_type = hasTurns() ? type : nullptr;  // the first call of allocate() takes it
  Object* const object = python.genericAlloc(type, items);
  t_type = nullptr;
  return object;
}

void* allocate(void* /*context*/, std::size_t size) {
  if (t_type != nullptr) {
    Object* const type = t_type;
    t_type = nullptr;
    if (void* const object = allocateFor(type, size)) {
      return object;
    }
  }
  return below.allocate(below.context, size);
}

void* allocateZeros(void* /*context*/, std::size_t count, std::size_t size) {
  return below.allocateZeros(below.context, count, size);
}

void release(void* /*context*/, void* address) {
  if (!Arenas::has(address)) {
    below.release(below.context, address);
    return;
  }
  arenas.release(address, !hasTurns());
}

void* resize(void* /*context*/, void* address, std::size_t size) {
  if (!Arenas::has(address)) {
    return below.resize(below.context, address, size);
  }
  void* const other = below.allocate(below.context, size);
  if (other != nullptr) {
    const std::size_t before = Arenas::sizeOf(address);
    memcpy(other, address, before < size ? before : size);
    release(nullptr, address);
  }
  return other;
}

void deallocType(Object* type) {
  forget(type);
  deallocOfType(type);
}

/** @brief Give a type arenas, if it is one that a class statement makes, and makes no types. */
void follow(Object* type) {
  if (slot<Dealloc*>(type, kDealloc) == deallocOfClasses &&
      slot<Alloc*>(type, kAlloc) == python.genericAlloc &&
      python.isSubtype(type, python.type) == 0) {
    slot<Alloc*>(type, kAlloc) = allocateInTurn;
  }
}

/** @brief type.__new__ */
Object* makeFollowedType(Object* meta, Object* arguments, Object* words) {
  Object* const type = makeType(meta, arguments, words);
  if (type != nullptr) {
    forget(type);  // one of a metaclass in C may have lain there
    follow(type);
  }
  return type;
}

// ---- functions -------------------------------------------------------------------------------

/** @brief hash() of a function: of its name, and of how many of that name were hashed before. */
Size hashFunction(Object* function) {
  if (const std::uint64_t* const known = hash_of.find(key(function))) {
    return static_cast<Size>(*known);
  }
  Object* const qual_name = python.attributeOf(function, "__qualname__");
  const auto epoch = salt + static_cast<std::uint64_t>(hasTurns() ? cell(kEpoch) : 0);
  const std::uint64_t module = hashed(charactersOf(python.moduleOf(function))) * 3;
  const std::uint64_t name = hashed(charactersOf(qual_name), module + epoch) | 1;
  if (qual_name != nullptr) {
    python.drop(qual_name);
  } else {
    python.clearError();
  }
  std::uint64_t* count = functions_of.find(name);
  count = count == nullptr ? functions_of.add(name, 0) : count;
  const std::uint64_t hash = count == nullptr ? name : mixed(name + ++*count);
  const auto positive = hash >> 1;  // never -1, which stands for an error
  hash_of.add(key(function), positive);
  return static_cast<Size>(positive);
}

void deallocFunction(Object* function) {
  if (hash_of.count() != 0) {
    hash_of.remove(key(function));
  }
  deallocOfFunction(function);
}

// ---- the beginning ---------------------------------------------------------------------------

/** @return whether types have their parts where they are looked for. @p sample: a class. */
bool isAsExpected(Object* sample) {
  return slot<Alloc*>(sample, kAlloc) == python.genericAlloc &&
         slot<Alloc*>(python.type, kAlloc) == python.genericAlloc &&
         slot<Hash*>(sample, kHash) == python.hashByAddress &&
         slot<Hash*>(python.function, kHash) == python.hashByAddress &&
         slot<Object*>(sample, kBase) == python.object;
}

void begin(Object* sample) {
  deallocOfClasses = slot<Dealloc*>(sample, kDealloc);
  makeType = slot<New*>(python.type, kNew);
  deallocOfFunction = slot<Dealloc*>(python.function, kDealloc);
  python.getAllocator(kObjects, &below);
  Allocator ours{nullptr, allocate, allocateZeros, resize, release};
  python.setAllocator(kObjects, &ours);
  deallocOfType = slot<Dealloc*>(python.type, kDealloc);
  slot<New*>(python.type, kNew) = makeFollowedType;
  slot<Dealloc*>(python.type, kDealloc) = deallocType;
  slot<Hash*>(python.function, kHash) = hashFunction;
  slot<Dealloc*>(python.function, kDealloc) = deallocFunction;
}

}  // namespace
}  // namespace move_base_abstract::native

#pragma GCC visibility push(default)
extern "C" {

// The functions that Python calls, by ctypes, while it has its lock.

/** @brief Give the objects of classes that are made from now on arenas. @p sample: a class;
 * @p is_random: whether arenas lie at places of which the system draws; @p left_out: the modules of
 * classes without arenas, each with a line's end before it, and one behind the last.
 * @return 0; 1: this Python is not the one that is known; 2: the system does not give the
 * addresses. */
int move_base_abstract_native_arenas(native::Object* sample, int is_random, const char* left_out) {
  if (!native::lookAll() || !native::isAsExpected(sample)) {
    return 1;
  }
  if (is_random != 0) {
    memcpy(&native::salt, reinterpret_cast<const void*>(getauxval(AT_RANDOM)),
           sizeof(native::salt));
  }
  native::left_out = strdup(left_out);
  if (native::left_out == nullptr || !native::arenas.reserve(native::salt)) {
    return 2;
  }
  native::begin(sample);
  return 0;
}

/** @brief Do the same for a type that is there already. */
void move_base_abstract_native_arenas_of(native::Object* type) {
  if (native::slot<native::New*>(type, native::kNew) == native::makeType) {
    native::slot<native::New*>(type, native::kNew) = native::makeFollowedType;  // makes types
  }
  native::follow(type);
}

/** @brief Leave the hash of a function as it is. */
void move_base_abstract_native_hashed(native::Object* function) {
  if (native::hash_of.find(native::key(function)) == nullptr) {
    native::hash_of.add(native::key(function),
                        static_cast<std::uint64_t>(native::python.hashByAddress(function)));
  }
}

/** @return whether an object lies in an arena. */
int move_base_abstract_native_arenas_has(const void* object) {
  return native::Arenas::has(object) ? 1 : 0;
}

/** @return whether a function is hashed by its name. */
int move_base_abstract_native_is_hashed_by_name(native::Object* function) {
  const std::uint64_t* const known = native::hash_of.find(native::key(function));
  const auto by_address = static_cast<std::uint64_t>(native::python.hashByAddress(function));
  return known == nullptr || *known != by_address ? 1 : 0;
}

}  // extern "C"
#pragma GCC visibility pop
