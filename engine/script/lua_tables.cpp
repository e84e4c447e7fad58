// Lua's tables, as ltable.c of Lua 5.1.5 has them (Copyright 1994-2012 Lua.org, PUC-Rio, MIT licence: NOTICE), with one
// difference: every slot that is gone through is counted as work. It takes the place of ltable in the copy of Lua's
// archive (CMakeLists.txt). In Lua's own, keys that collide, tables that are rebuilt and next() over emptied tables
// take millions of steps for one instruction.
//
// Numbers, texts, true and false stand in the same slots as in Lua's own, so that pairs() goes through them in the same
// order: lua_tables_test compares. Objects stand by the order of their making, not by their addresses. The types are
// Lua's, as lobject.h lays them out on x86-64; lua_tables_test checks that as well.
#include <algorithm>
#include <array>
#include <bit>
#include <climits>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <lua.hpp>

#include "engine/script/work.hpp"

using verisim::script::raise_if_spent;
using verisim::script::work;

// --- lobject.h ------------------------------------------------------------------------------------------------------

union GCObject;
union TString {
  struct {
    GCObject* next;
    std::uint8_t type, marked, reserved;
    std::uint32_t hash;
    std::size_t length;
  } header;
};
union GCObject {
  struct {
    GCObject* next;
    std::uint8_t type, marked;
  } header;
};
union LuaPayload {
  GCObject* object;
  void* pointer;
  double number;
  int boolean;
};
struct lua_TValue {
  LuaPayload value;
  int type;
};
struct Node {
  lua_TValue value;
  LuaPayload key;
  int key_type;
  Node* next;  ///< in the chain of keys that collide
};
struct Table {
  GCObject* next;
  std::uint8_t type, marked;
  std::uint8_t flags;         ///< a bit per metamethod that is known not to be there
  std::uint8_t log_of_nodes;  ///< the number of nodes is a power of two
  Table* metatable;
  lua_TValue* array;  ///< of the keys 1 … array_size
  Node* nodes;        ///< of all other keys
  Node* last_free;    ///< all nodes from here on are taken
  GCObject* gray_list;
  int array_size;
};
static_assert(sizeof(TString) == 24 && sizeof(lua_TValue) == 16 && sizeof(Node) == 40 && sizeof(Table) == 64);

// Defined in other parts of the archive.
extern const lua_TValue luaO_nilobject_;
int luaO_log2(unsigned int x);
int luaO_rawequalObj(const lua_TValue* a, const lua_TValue* b);
void* luaM_realloc_(lua_State* L, void* block, std::size_t old_size, std::size_t size);
void luaG_runerror(lua_State* L, const char* format, ...);
void luaC_link(lua_State* L, GCObject* object, std::uint8_t type);
void luaC_barrierback(lua_State* L, Table* table);

// Defined here.
const lua_TValue* luaH_getnum(Table* t, int key);
const lua_TValue* luaH_getstr(Table* t, TString* key);
const lua_TValue* luaH_get(Table* t, const lua_TValue* key);
lua_TValue* luaH_set(lua_State* L, Table* t, const lua_TValue* key);
lua_TValue* luaH_setnum(lua_State* L, Table* t, int key);
lua_TValue* luaH_setstr(lua_State* L, Table* t, TString* key);
Table* luaH_new(lua_State* L, int array_size, int node_count);
void luaH_resizearray(lua_State* L, Table* t, int array_size);
void luaH_free(lua_State* L, Table* t);
int luaH_next(lua_State* L, Table* t, lua_TValue* key);
int luaH_getn(Table* t);

namespace {

constexpr int kBitsMax = 26;  // of sizes
constexpr int kDeadKey = 11;  // the key of an entry that is gone
constexpr int kWhiteBits = 3;
constexpr int kBlackBit = 4;

Node no_nodes{.value = {.value = {.object = nullptr}, .type = LUA_TNIL},
              .key = {.object = nullptr},
              .key_type = LUA_TNIL,
              .next = nullptr};  // of a table without nodes; never written

using Sizes = std::array<int, kBitsMax + 1>;  ///< [i]: number of keys from 2^(i-1) + 1 to 2^i

bool is_nil(const lua_TValue& value) {
  return value.type == LUA_TNIL;
}
bool is_collected(int type) {
  return type >= LUA_TSTRING;
}
int node_count(const Table* t) {
  return 1 << t->log_of_nodes;
}
lua_TValue number_key(int number) {
  return {.value = {.number = static_cast<double>(number)}, .type = LUA_TNUMBER};
}
lua_TValue key_of(const Node* node) {
  return {.value = node->key, .type = node->key_type};
}

Node* node_of_remainder(const Table* t, std::uint32_t n) {
  return t->nodes + n % static_cast<std::uint32_t>((node_count(t) - 1) | 1);
}
Node* node_of_low_bits(const Table* t, std::uint32_t n) {
  return t->nodes + (n & static_cast<std::uint32_t>(node_count(t) - 1));
}

Node* place_of_number(const Table* t, double number) {
  if (number == 0) return t->nodes;  // -0 too
  std::array<std::uint32_t, 2> halves{};
  std::memcpy(halves.data(), &number, sizeof number);
  return node_of_remainder(t, halves[0] + halves[1]);
}
Node* place_of_text(const Table* t, const TString* text) {
  return node_of_low_bits(t, text->header.hash);
}

/// Where a key stands unless another was there first.
Node* main_place(const Table* t, const lua_TValue& key) {
  switch (key.type) {
    case LUA_TNUMBER:
      return place_of_number(t, key.value.number);
    case LUA_TSTRING:
      return place_of_text(t, reinterpret_cast<const TString*>(key.value.object));
    case LUA_TBOOLEAN:
      return node_of_low_bits(t, static_cast<std::uint32_t>(key.value.boolean));
    case LUA_TLIGHTUSERDATA:
      return node_of_remainder(t, static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(key.value.pointer)));
    default:  // an object: not by its address, which differs from run to run and with it the work
      return node_of_remainder(t, static_cast<std::uint32_t>(verisim::script::creation_order_of(key.value.pointer)));
  }
}

/// The number as an index of the array part, or -1.
int array_index(const lua_TValue& key) {
  if (key.type != LUA_TNUMBER) return -1;
  const double number = key.value.number;
  if (!(number > INT_MIN && number <= INT_MAX)) return -1;
  const int index = static_cast<int>(number);
  return index == number ? index : -1;
}

/// The value in the chain from `node` whose key is as wanted, or Lua's nil.
template <typename IsWanted>
const lua_TValue* find_in_chain(const Node* node, const IsWanted& is_wanted) {
  for (; node != nullptr; node = node->next) {
    if (is_wanted(*node)) return &node->value;
    ++work.used;
  }
  return &luaO_nilobject_;
}

/// Position of a key in the order of next(): the array part, then the nodes; -1 before the first.
int position_of(lua_State* L, Table* t, const lua_TValue* key) {
  if (key->type == LUA_TNIL) return -1;
  const int index = array_index(*key);
  if (0 < index && index <= t->array_size) return index - 1;
  for (Node* node = main_place(t, *key); node != nullptr; node = node->next, ++work.used) {
    const lua_TValue here = key_of(node);
    if (luaO_rawequalObj(&here, key) != 0 ||
        (node->key_type == kDeadKey && is_collected(key->type) && node->key.object == key->value.object))
      return static_cast<int>(node - t->nodes) + t->array_size;
  }
  luaG_runerror(L, "invalid key to 'next'");
  return 0;
}

// --- rebuilding -----------------------------------------------------------------------------------------------------

template <typename Element>
void reallocate(lua_State* L, Element*& block, int old_count, int count) {
  block = static_cast<Element*>(luaM_realloc_(L, block, static_cast<std::size_t>(old_count) * sizeof(Element),
                                              static_cast<std::size_t>(count) * sizeof(Element)));
}

int log_upwards(int size) {
  return luaO_log2(static_cast<unsigned int>(size - 1)) + 1;
}

int count_index(const lua_TValue& key, Sizes& sizes) {
  const int index = array_index(key);
  if (index <= 0 || index > (1 << kBitsMax)) return 0;
  ++sizes[static_cast<std::size_t>(log_upwards(index))];
  return 1;
}

int count_array(const Table* t, Sizes& sizes) {
  int used = 0;
  int i = 1;
  for (int log = 0, end = 1; log <= kBitsMax; ++log, end *= 2) {
    const int last = std::min(end, t->array_size);
    if (i > last) break;
    int here = 0;
    for (; i <= last; ++i)
      if (!is_nil(t->array[i - 1])) ++here;
    sizes[static_cast<std::size_t>(log)] += here;
    used += here;
  }
  return used;
}

int count_nodes(const Table* t, Sizes& sizes, int& indices) {
  int used = 0;
  for (int i = node_count(t) - 1; i >= 0; --i) {
    const Node* node = t->nodes + i;
    if (is_nil(node->value)) continue;
    indices += count_index(key_of(node), sizes);
    ++used;
  }
  return used;
}

/// The largest n such that more than half of 1 … n are in use; `indices` becomes n. Returns how many of them are.
int choose_array_size(const Sizes& sizes, int& indices) {
  int below = 0;
  int chosen = 0;
  int in_chosen = 0;
  for (int i = 0, end = 1; end / 2 < indices; ++i, end *= 2) {
    const int here = sizes[static_cast<std::size_t>(i)];
    if (here > 0) {
      below += here;
      if (below > end / 2) {
        chosen = end;
        in_chosen = below;
      }
    }
    if (below == indices) break;
  }
  indices = chosen;
  return in_chosen;
}

void set_array_size(lua_State* L, Table* t, int size) {
  reallocate(L, t->array, t->array_size, size);
  for (int i = t->array_size; i < size; ++i) t->array[i].type = LUA_TNIL;
  t->array_size = size;
}

void make_nodes(lua_State* L, Table* t, int size) {
  int log = 0;
  if (size == 0) {
    t->nodes = &no_nodes;
  } else {
    log = log_upwards(size);
    if (log > kBitsMax) luaG_runerror(L, "table overflow");
    size = 1 << log;
    Node* nodes = nullptr;
    reallocate(L, nodes, 0, size);
    t->nodes = nodes;
    for (int i = 0; i < size; ++i) {
      nodes[i].next = nullptr;
      nodes[i].key_type = LUA_TNIL;
      nodes[i].value.type = LUA_TNIL;
    }
  }
  t->log_of_nodes = static_cast<std::uint8_t>(log);
  t->last_free = t->nodes + size;
}

/// Nothing in here may raise for spent work: entries would be lost. add_key looks before it comes here.
void resize(lua_State* L, Table* t, int array_size, int nodes) {
  const int old_array_size = t->array_size;
  const int old_node_count = node_count(t);
  Node* old_nodes = t->nodes;
  work.used += static_cast<std::uint64_t>(old_node_count) + static_cast<std::uint64_t>(std::max(array_size, nodes)) / 4;
  if (array_size > old_array_size) set_array_size(L, t, array_size);
  make_nodes(L, t, nodes);
  if (array_size < old_array_size) {
    t->array_size = array_size;
    for (int i = array_size; i < old_array_size; ++i)
      if (!is_nil(t->array[i])) *luaH_setnum(L, t, i + 1) = t->array[i];
    reallocate(L, t->array, old_array_size, array_size);
  }
  for (int i = old_node_count - 1; i >= 0; --i) {
    const Node& old = old_nodes[i];
    if (is_nil(old.value)) continue;
    const lua_TValue key = key_of(&old);
    *luaH_set(L, t, &key) = old.value;
  }
  if (old_nodes != &no_nodes) reallocate(L, old_nodes, old_node_count, 0);
}

void rebuild_for(lua_State* L, Table* t, const lua_TValue* key) {
  Sizes sizes{};
  work.used += static_cast<std::uint64_t>(t->array_size) / 4;
  int indices = count_array(t, sizes);
  int entries = indices;
  entries += count_nodes(t, sizes, indices);
  indices += count_index(*key, sizes);
  ++entries;
  const int in_array = choose_array_size(sizes, indices);
  resize(L, t, indices, entries - in_array);
}

Node* free_node(Table* t) {
  while (t->last_free > t->nodes) {
    --t->last_free;
    if (t->last_free->key_type == LUA_TNIL) return t->last_free;
  }
  return nullptr;
}

/// If the key's main place is taken by a key that stands there for want of its own, that one gives way; else the new
/// key takes a free node and hangs behind.
lua_TValue* add_key(lua_State* L, Table* t, const lua_TValue* key) {
  Node* place = main_place(t, *key);
  if (!is_nil(place->value) || place == &no_nodes) {
    Node* free = free_node(t);
    if (free == nullptr) {
      raise_if_spent(L);
      rebuild_for(L, t, key);
      return luaH_set(L, t, key);
    }
    Node* other = main_place(t, key_of(place));
    if (other != place) {
      for (; other->next != place; other = other->next) ++work.used;
      other->next = free;
      *free = *place;
      place->next = nullptr;
      place->value.type = LUA_TNIL;
    } else {
      free->next = place->next;
      place->next = free;
      place = free;
    }
  }
  place->key = key->value;
  place->key_type = key->type;
  if (is_collected(key->type) && (key->value.object->header.marked & kWhiteBits) != 0 && (t->marked & kBlackBit) != 0)
    luaC_barrierback(L, t);
  return &place->value;
}

}  // namespace

// --- what the rest of Lua calls -------------------------------------------------------------------------------------

const lua_TValue* luaH_getnum(Table* t, int key) {
  if (static_cast<unsigned int>(key) - 1U < static_cast<unsigned int>(t->array_size)) return &t->array[key - 1];
  const auto number = static_cast<double>(key);
  return find_in_chain(place_of_number(t, number), [number](const Node& node) {
    return node.key_type == LUA_TNUMBER && node.key.number == number;
  });
}

const lua_TValue* luaH_getstr(Table* t, TString* key) {
  return find_in_chain(place_of_text(t, key), [key](const Node& node) {
    return node.key_type == LUA_TSTRING && reinterpret_cast<const TString*>(node.key.object) == key;
  });
}

const lua_TValue* luaH_get(Table* t, const lua_TValue* key) {
  if (key->type == LUA_TNIL) return &luaO_nilobject_;
  if (key->type == LUA_TSTRING) return luaH_getstr(t, reinterpret_cast<TString*>(key->value.object));
  if (key->type == LUA_TNUMBER) {
    const double number = key->value.number;
    if (number >= INT_MIN && number <= INT_MAX && static_cast<int>(number) == number)
      return luaH_getnum(t, static_cast<int>(number));
  }
  return find_in_chain(main_place(t, *key), [key](const Node& node) {
    const lua_TValue here = key_of(&node);
    return luaO_rawequalObj(&here, key) != 0;
  });
}

lua_TValue* luaH_set(lua_State* L, Table* t, const lua_TValue* key) {
  const lua_TValue* known = luaH_get(t, key);
  t->flags = 0;
  if (known != &luaO_nilobject_) return const_cast<lua_TValue*>(known);
  if (key->type == LUA_TNIL)
    luaG_runerror(L, "table index is nil");
  else if (key->type == LUA_TNUMBER && std::isnan(key->value.number))
    luaG_runerror(L, "table index is NaN");
  return add_key(L, t, key);
}

lua_TValue* luaH_setnum(lua_State* L, Table* t, int key) {
  const lua_TValue* known = luaH_getnum(t, key);
  if (known != &luaO_nilobject_) return const_cast<lua_TValue*>(known);
  const lua_TValue number = number_key(key);
  return add_key(L, t, &number);
}

lua_TValue* luaH_setstr(lua_State* L, Table* t, TString* key) {
  const lua_TValue* known = luaH_getstr(t, key);
  if (known != &luaO_nilobject_) return const_cast<lua_TValue*>(known);
  const lua_TValue text{.value = {.object = reinterpret_cast<GCObject*>(key)}, .type = LUA_TSTRING};
  return add_key(L, t, &text);
}

Table* luaH_new(lua_State* L, int array_size, int nodes) {
  raise_if_spent(L);
  Table* t = nullptr;
  reallocate(L, t, 0, 1);
  luaC_link(L, reinterpret_cast<GCObject*>(t), LUA_TTABLE);
  t->metatable = nullptr;
  t->flags = 0xff;
  t->array = nullptr;  // what the collector finds should an allocation below fail
  t->array_size = 0;
  t->log_of_nodes = 0;
  t->nodes = &no_nodes;
  set_array_size(L, t, array_size);
  make_nodes(L, t, nodes);
  return t;
}

void luaH_resizearray(lua_State* L, Table* t, int array_size) {
  resize(L, t, array_size, t->nodes == &no_nodes ? 0 : node_count(t));
}

void luaH_free(lua_State* L, Table* t) {
  if (t->nodes != &no_nodes) reallocate(L, t->nodes, node_count(t), 0);
  reallocate(L, t->array, t->array_size, 0);
  reallocate(L, t, 1, 0);
}

int luaH_next(lua_State* L, Table* t, lua_TValue* key) {
  const int before = position_of(L, t, key);
  int i = before + 1;
  const int end = t->array_size + node_count(t);
  while (i < end && is_nil(i < t->array_size ? t->array[i] : t->nodes[i - t->array_size].value)) ++i;
  work.used += static_cast<std::uint64_t>(i - before);
  raise_if_spent(L);
  if (i == end) return 0;
  key[0] = i < t->array_size ? number_key(i + 1) : key_of(t->nodes + (i - t->array_size));
  key[1] = i < t->array_size ? t->array[i] : t->nodes[i - t->array_size].value;
  return 1;
}

int luaH_getn(Table* t) {
  auto j = static_cast<unsigned int>(t->array_size);
  unsigned int i = 0;
  if (j > 0 && is_nil(t->array[j - 1])) {
    while (j - i > 1) {
      const unsigned int middle = (i + j) / 2;
      (is_nil(t->array[middle - 1]) ? j : i) = middle;
    }
    return static_cast<int>(i);
  }
  if (t->nodes == &no_nodes) return static_cast<int>(j);
  const auto there = [t](unsigned int k) { return !is_nil(*luaH_getnum(t, static_cast<int>(k))); };
  for (i = j++; there(j);) {
    i = j;
    j *= 2;
    if (j > static_cast<unsigned int>(INT_MAX - 2)) {  // keys chosen to mislead: one by one
      for (i = 1; there(i); ++i) ++work.used;
      return static_cast<int>(i - 1);
    }
  }
  while (j - i > 1) {
    const unsigned int middle = (i + j) / 2;
    (there(middle) ? i : j) = middle;
  }
  return static_cast<int>(i);
}
