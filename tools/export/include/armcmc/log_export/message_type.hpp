#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace armcmc::log_export {

/// One member of a message: a number, or an array of numbers of fixed size.
struct MessageField {
  std::string name;
  std::string type;        ///< As in the .lcm file: "int64_t", "double", "byte", ...
  std::vector<int> dims;   ///< Empty: a single number.
  std::size_t offset = 0;  ///< Of its first byte in the encoded message, which begins with the 8-byte fingerprint.
  std::size_t count = 1;   ///< Numbers.
  std::size_t width = 8;   ///< Bytes a number.
};

/// One type of message as its .lcm file describes it: enough to read an encoded message without generated code, so
/// that a log stays readable as long as the .lcm file is kept.
struct MessageType {
  std::string name;
  std::int64_t fingerprint = 0;  ///< As lcm-gen computes it: over the names, types and dimensions of the members.
  std::size_t encoded_size = 8;
  std::vector<MessageField> fields;

  /// @return nullptr when there is none.
  [[nodiscard]] const MessageField* Find(std::string_view field) const;
};

/// The structs of .lcm text (one file or several after each other). Members are numbers and arrays of fixed size, which
/// is all that our types use.
/// @throws support::InputError naming the line and what was expected.
[[nodiscard]] std::vector<MessageType> ParseMessageTypes(std::string_view text);

/// Every released type of the product.
[[nodiscard]] const std::vector<MessageType>& ReleasedTypes();

/// The released type of that encoded message, nullptr when it is none of ours: unknown fingerprint, or not its length.
[[nodiscard]] const MessageType* TypeOf(std::span<const std::uint8_t> message);

/// First eight bytes as the fingerprint; 0 for a shorter message.
[[nodiscard]] std::int64_t FingerprintOf(std::span<const std::uint8_t> message);

/// Number `index` of a field. Integers beyond 2^53 lose their last bits. @pre the message is of the field's type.
[[nodiscard]] double NumberAt(std::span<const std::uint8_t> message, const MessageField& field, std::size_t index);
/// The same for integer fields, exact.
[[nodiscard]] std::int64_t IntegerAt(std::span<const std::uint8_t> message, const MessageField& field,
                                     std::size_t index);
/// Row `row` of a two-dimensional byte field as zero-padded ASCII; characters that are not printable become '?'.
[[nodiscard]] std::string TextAt(std::span<const std::uint8_t> message, const MessageField& field, std::size_t row);

}  // namespace armcmc::log_export
