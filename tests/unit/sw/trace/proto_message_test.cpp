#include "sw/trace/proto_message.h"

#include <gtest/gtest.h>

#include <string>

namespace stereotlm::trace {
namespace {

// The values of the guide "Encoding" of Protocol Buffers.
TEST(ProtoMessage, IsEncodedAsInTheGuideOfProtocolBuffers) {
  ProtoMessage message;
  message.integer(1, 150);
  EXPECT_EQ(message.bytes(), "\x08\x96\x01");
  ProtoMessage outer;
  outer.message(3, message);
  EXPECT_EQ(outer.bytes(), "\x1a\x03\x08\x96\x01");
  message.clear();
  message.text(2, "testing");
  EXPECT_EQ(message.bytes(), "\x12\x07testing");
}

TEST(ProtoMessage, EncodesTheSmallestAndTheLargestNumbers) {
  ProtoMessage message;
  message.integer(1, 0);
  message.integer(1, 127);
  message.integer(1, 128);
  message.integer(1, UINT64_MAX);
  EXPECT_EQ(message.bytes(),
            std::string("\x08\x00\x08\x7f\x08\x80\x01\x08", 8) + std::string(9, '\xff') + '\x01');
}

TEST(ProtoMessage, StoresFixedNumbersWithTheLowestByteFirst) {
  ProtoMessage message;
  message.fixed(47, 0x0102030405060708);
  EXPECT_EQ(message.bytes(), "\xf9\x02\x08\x07\x06\x05\x04\x03\x02\x01");
  message.clear();
  message.real(44, 1.0);
  EXPECT_EQ(message.bytes(), std::string("\xe1\x02\0\0\0\0\0\0\xf0\x3f", 10));
}

}  // namespace
}  // namespace stereotlm::trace
