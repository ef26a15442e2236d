#include "sw/stats/json_schema.h"

#include <utility>

namespace stereotlm::stats {

Schema text() { return {{"type", "string"}, {"minLength", 1}}; }
Schema truth() { return {{"type", "boolean"}}; }
Schema count() { return {{"type", "integer"}, {"minimum", 0}}; }
Schema from_one() { return {{"type", "integer"}, {"minimum", 1}}; }
Schema any_number() { return {{"type", "number"}}; }
Schema amount() { return {{"type", "number"}, {"minimum", 0}}; }
Schema above_zero() { return {{"type", "number"}, {"exclusiveMinimum", 0}}; }
Schema share() { return {{"type", "number"}, {"minimum", 0}, {"maximum", 1}}; }
Schema percentage() { return {{"type", "number"}, {"minimum", 0}, {"maximum", 100}}; }
Schema one_of_words(std::vector<std::string> words) { return {{"enum", std::move(words)}}; }

Schema list_of(Schema items, int least) {
  Schema schema = {{"type", "array"}, {"items", std::move(items)}};
  if (least > 0) schema["minItems"] = least;
  return schema;
}

Schema map_to(Schema values) { return {{"type", "object"}, {"additionalProperties", std::move(values)}}; }
Schema either(const Schema& one, const Schema& other) { return {{"oneOf", {one, other}}}; }

Schema object_of(const std::vector<Property>& properties) {
  Schema schema = {{"type", "object"}, {"properties", Schema::object()}, {"required", Schema::array()}};
  for (const Property& property : properties) {
    std::string key = property.key;
    if (key.back() == '?') {
      key.pop_back();
    } else {
      schema["required"].push_back(key);
    }
    Schema& its = schema["properties"][key] = property.schema;
    if (!property.meaning.empty()) its["description"] = property.meaning;
  }
  schema["additionalProperties"] = false;
  return schema;
}

Schema document_of(const std::string& title, std::vector<Property> properties) {
  properties.insert(properties.begin(), {"schema", {{"const", 1}}});
  Schema schema = {{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", title}};
  schema.update(object_of(properties));
  return schema;
}

void require_together(Schema& object, const std::vector<std::string>& keys) {
  for (const std::string& key : keys) {
    for (const std::string& other : keys) {
      if (other != key) object["dependentRequired"][key].push_back(other);
    }
  }
}

}  // namespace stereotlm::stats
