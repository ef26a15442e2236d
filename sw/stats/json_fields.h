#pragma once

#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "sw/stats/json_schema.h"

// The JSON object of a struct. For each struct, a function fields_of(const Struct*) in its namespace lists
// the keys: it returns a tuple of Field, Part and Merged, in the order of the keys. The writer, the reader
// and the schema of the object follow from this list.
namespace stereotlm::stats {

using Json = nlohmann::ordered_json;
using Pointer = Json::json_pointer;
using MakeSchema = Schema (*)();

enum class Presence { kAlways, kUnlessEmpty };  // of a key whose value is not a std::optional

// A key, and the member that holds its value. The key of an empty std::optional is left out.
template <typename Object, typename Value>
struct Field {
  const char* key;
  Value Object::*member;
  const char* meaning = "";     // see Property
  MakeSchema schema = nullptr;  // null: that of the type of the value
  Presence presence = Presence::kAlways;
};
template <typename Object, typename Value>
Field(const char*, Value Object::*, const char* = "", MakeSchema = nullptr, Presence = Presence::kAlways)
    -> Field<Object, Value>;

// A key whose value is an object with some members of the same struct.
template <typename... Fields>
struct Part {
  const char* key;
  std::tuple<Fields...> fields;
};
template <typename... Fields>
Part(const char*, std::tuple<Fields...>) -> Part<Fields...>;

// A member whose keys stand among those of the struct itself. If the member is empty, none of them is there.
template <typename Object, typename Value>
struct Merged {
  std::optional<Value> Object::*member;
};
template <typename Object, typename Value>
Merged(std::optional<Value> Object::*) -> Merged<Object, Value>;

template <typename Value, typename = void>
struct HasFields : std::false_type {};
template <typename Value>
struct HasFields<Value, std::void_t<decltype(fields_of(static_cast<const Value*>(nullptr)))>>
    : std::true_type {};

template <typename Value>
struct IsOptional : std::false_type {};
template <typename Value>
struct IsOptional<std::optional<Value>> : std::true_type {};

template <typename Value>
struct IsVector : std::false_type {};
template <typename Value>
struct IsVector<std::vector<Value>> : std::true_type {};

// Whether an object with this value lacks the key.
template <typename Object, typename Value>
bool is_left_out(const Field<Object, Value>& field, const Value& value) {
  if constexpr (IsOptional<Value>::value) {
    return !value.has_value();
  } else if constexpr (IsVector<Value>::value || std::is_same_v<Value, std::string>) {
    return field.presence == Presence::kUnlessEmpty && value.empty();
  } else {
    return false;
  }
}

template <typename Fields, typename Visit>
void each(const Fields& fields, const Visit& visit) {
  std::apply([&](const auto&... field) { (visit(field), ...); }, fields);
}

// Calls visit(path, field, value) for each Field of an object that lies at this path of a document.
template <typename Object, typename Visit>
void each_value(Object& object, const Pointer& path, const Visit& visit) {
  each(fields_of(&object), [&](const auto& field) { visit_field(object, path, field, visit); });
}
template <typename Object, typename Struct, typename Value, typename Visit>
void visit_field(Object& object, const Pointer& path, const Field<Struct, Value>& field, const Visit& visit) {
  visit(path / field.key, field, object.*field.member);
}
template <typename Object, typename... Fields, typename Visit>
void visit_field(Object& object, const Pointer& path, const Part<Fields...>& part, const Visit& visit) {
  each(part.fields, [&](const auto& field) { visit_field(object, path / part.key, field, visit); });
}
template <typename Object, typename Struct, typename Value, typename Visit>
void visit_field(Object& object, const Pointer& path, const Merged<Struct, Value>& merged,
                 const Visit& visit) {
  if (auto& value = object.*merged.member) each_value(*value, path, visit);
}

// The JSON of a value.
template <typename Value>
Json json_of(const Value& value) {
  if constexpr (HasFields<Value>::value) {
    Json json = Json::object();
    each_value(value, Pointer(), [&](const Pointer& path, const auto& field, const auto& its) {
      if (!is_left_out(field, its)) json[path] = json_of(its);
    });
    return json;
  } else if constexpr (IsOptional<Value>::value) {
    return json_of(*value);
  } else if constexpr (IsVector<Value>::value) {
    Json json = Json::array();
    for (const auto& item : value) json.push_back(json_of(item));
    return json;
  } else {
    return value;
  }
}

template <typename Value>
std::vector<Property> properties_of();

// The schema of the values of a type.
template <typename Value>
Schema schema_of() {
  if constexpr (HasFields<Value>::value) {
    return object_of(properties_of<Value>());
  } else if constexpr (IsVector<Value>::value) {
    return list_of(schema_of<typename Value::value_type>());
  } else if constexpr (IsOptional<Value>::value) {
    return schema_of<typename Value::value_type>();
  } else if constexpr (std::is_same_v<Value, std::string>) {
    return text();
  } else {
    return std::is_integral_v<Value> ? count() : amount();
  }
}

template <typename Object, typename Value>
void describe(std::vector<Property>& properties, const Field<Object, Value>& field) {
  const bool is_optional = IsOptional<Value>::value || field.presence == Presence::kUnlessEmpty;
  properties.push_back({std::string(field.key) + (is_optional ? "?" : ""),
                        field.schema == nullptr ? schema_of<Value>() : field.schema(), field.meaning});
}
template <typename... Fields>
void describe(std::vector<Property>& properties, const Part<Fields...>& part) {
  std::vector<Property> inner;
  each(part.fields, [&](const auto& field) { describe(inner, field); });
  properties.push_back({part.key, object_of(inner)});
}
template <typename Object, typename Value>
void describe(std::vector<Property>& properties, const Merged<Object, Value>& /*merged*/) {
  for (Property& property : properties_of<Value>()) {
    if (property.key.back() != '?') property.key += '?';
    properties.push_back(std::move(property));
  }
}

template <typename Value>
std::vector<Property> properties_of() {
  std::vector<Property> properties;
  each(fields_of(static_cast<const Value*>(nullptr)),
       [&](const auto& field) { describe(properties, field); });
  return properties;
}

}  // namespace stereotlm::stats
