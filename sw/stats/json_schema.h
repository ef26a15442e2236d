#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

// Parts of JSON Schemas (draft 2020-12), from which those of the documents of --json are made.
namespace stereotlm::stats {

using Schema = nlohmann::ordered_json;

Schema text();                                        // not empty
Schema truth();                                       // true or false
Schema count();                                       // an integer, 0 or more
Schema from_one();                                    // an integer, 1 or more
Schema any_number();                                  // any
Schema amount();                                      // a number, 0 or more
Schema above_zero();                                  // a number above 0
Schema share();                                       // 0..1
Schema percentage();                                  // 0..100
Schema one_of_words(std::vector<std::string> words);  // one of these texts
Schema list_of(Schema items, int least = 0);          // at least so many items
Schema map_to(Schema values);                         // an object with any keys
Schema either(const Schema& one, const Schema& other);

// A key of an object, and what its value is. An optional key ends in "?" here.
struct Property {
  std::string key;
  Schema schema;
  std::string meaning = "";  // the description; empty: none
};

// An object with these keys and no others.
Schema object_of(const std::vector<Property>& properties);

// The schema of a document, which has "schema": 1 in front of these keys.
Schema document_of(const std::string& title, std::vector<Property> properties);

// The schema says that the keys stand together: each requires all others.
void require_together(Schema& object, const std::vector<std::string>& keys);

}  // namespace stereotlm::stats
