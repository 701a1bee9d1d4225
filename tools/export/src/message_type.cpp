#include "armcmc/log_export/message_type.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cstring>
#include <utility>

#include "armcmc/support/program.hpp"

namespace armcmc::embedded {
std::string_view MessageTypes() noexcept;
}

namespace armcmc::log_export {
namespace {

constexpr std::array<std::pair<std::string_view, std::size_t>, 8> kTypes = {{{"int8_t", 1},
                                                                             {"int16_t", 2},
                                                                             {"int32_t", 4},
                                                                             {"int64_t", 8},
                                                                             {"float", 4},
                                                                             {"double", 8},
                                                                             {"byte", 1},
                                                                             {"boolean", 1}}};

/// Words, numbers and punctuation of .lcm text, without comments.
class Tokens {
 public:
  explicit Tokens(std::string_view text) : text_(text) { Advance(); }

  [[nodiscard]] const std::string& Peek() const { return token_; }
  [[nodiscard]] bool done() const { return token_.empty(); }
  std::string Take() {
    std::string taken = std::move(token_);
    Advance();
    return taken;
  }
  bool TakeIf(std::string_view wanted) {
    if (token_ != wanted) return false;
    Advance();
    return true;
  }
  void Expect(std::string_view wanted) {
    if (!TakeIf(wanted)) Fail("expected " + std::string(wanted) + " instead of " + token_);
  }
  [[noreturn]] void Fail(const std::string& problem) const {
    throw support::InputError("message types, line " + std::to_string(line_) + ": " + problem);
  }

 private:
  void Advance() {
    SkipBlanks();
    const std::size_t begin = at_;
    const auto is_word = [this] {
      return at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) != 0 || text_[at_] == '_');
    };
    while (is_word()) ++at_;
    if (at_ == begin && at_ < text_.size()) ++at_;
    token_ = text_.substr(begin, at_ - begin);
  }
  void SkipBlanks() {
    while (at_ < text_.size()) {
      if (std::isspace(static_cast<unsigned char>(text_[at_])) != 0) {
        line_ += text_[at_] == '\n' ? 1 : 0;
        ++at_;
      } else if (text_.substr(at_, 2) == "//") {
        at_ = std::min(text_.find('\n', at_), text_.size());
      } else {
        return;
      }
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
  std::string token_;
};

// The hash of lcm-gen, on unsigned words; only the shift to the right keeps the sign.
void Hash(std::uint64_t byte, std::uint64_t* hash) {
  const auto spread = static_cast<std::uint64_t>(static_cast<std::int64_t>(*hash) >> 55);
  *hash = ((*hash << 8) ^ spread) + byte;
}

void Hash(std::string_view text, std::uint64_t* hash) {
  Hash(text.size(), hash);
  for (const char c : text) Hash(static_cast<std::uint64_t>(static_cast<unsigned char>(c)), hash);
}

std::int64_t Fingerprint(const MessageType& type) {
  std::uint64_t hash = 0x12345678;
  for (const MessageField& field : type.fields) {
    Hash(field.name, &hash);
    Hash(field.type, &hash);
    Hash(field.dims.size(), &hash);
    for (const int size : field.dims) {
      Hash(std::uint64_t{0}, &hash);  // a constant size
      Hash(std::to_string(size), &hash);
    }
  }
  return static_cast<std::int64_t>(std::rotl(hash, 1));
}

MessageField ParseField(const std::string& type, std::size_t width, Tokens* tokens) {
  MessageField field;
  field.name = tokens->Take();
  field.type = type;
  field.width = width;
  while (tokens->TakeIf("[")) {
    const std::string size = tokens->Take();
    int value = 0;
    const auto result = std::from_chars(size.data(), size.data() + size.size(), value);
    if (result.ptr != size.data() + size.size() || value < 1)
      tokens->Fail("array size " + size + ": expected a number, the arrays of these types have a fixed size");
    field.dims.push_back(value);
    field.count *= static_cast<std::size_t>(value);
    tokens->Expect("]");
  }
  return field;
}

MessageType ParseStruct(Tokens* tokens) {
  MessageType type;
  type.name = tokens->Take();
  tokens->Expect("{");
  while (!tokens->TakeIf("}")) {
    if (tokens->done()) tokens->Fail("expected } at the end of " + type.name);
    if (tokens->TakeIf("const")) {
      while (!tokens->done() && !tokens->TakeIf(";")) tokens->Take();
      continue;
    }
    const std::string word = tokens->Take();
    const auto* known = std::find_if(kTypes.begin(), kTypes.end(), [&](const auto& t) { return t.first == word; });
    if (known == kTypes.end()) tokens->Fail("type " + word + ": expected a number type of fixed size");
    do {
      MessageField field = ParseField(word, known->second, tokens);
      field.offset = type.encoded_size;
      type.encoded_size += field.count * field.width;
      type.fields.push_back(std::move(field));
    } while (tokens->TakeIf(","));
    tokens->Expect(";");
  }
  type.fingerprint = Fingerprint(type);
  return type;
}

std::uint64_t BigEndian(const std::uint8_t* bytes, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value = value << 8 | bytes[i];
  return value;
}

}  // namespace

const MessageField* MessageType::Find(std::string_view field) const {
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const auto& f) { return f.name == field; });
  return found == fields.end() ? nullptr : &*found;
}

std::vector<MessageType> ParseMessageTypes(std::string_view text) {
  Tokens tokens(text);
  std::vector<MessageType> types;
  while (!tokens.done()) {
    if (tokens.TakeIf("package")) {
      while (!tokens.done() && !tokens.TakeIf(";")) tokens.Take();
    } else {
      tokens.Expect("struct");
      types.push_back(ParseStruct(&tokens));
    }
  }
  return types;
}

const std::vector<MessageType>& ReleasedTypes() {
  static const std::vector<MessageType> types = ParseMessageTypes(embedded::MessageTypes());
  return types;
}

std::int64_t FingerprintOf(std::span<const std::uint8_t> message) {
  return message.size() < 8 ? 0 : static_cast<std::int64_t>(BigEndian(message.data(), 8));
}

const MessageType* TypeOf(std::span<const std::uint8_t> message) {
  const std::int64_t fingerprint = FingerprintOf(message);
  for (const MessageType& type : ReleasedTypes())
    if (type.fingerprint == fingerprint && type.encoded_size == message.size()) return &type;
  return nullptr;
}

std::int64_t IntegerAt(std::span<const std::uint8_t> message, const MessageField& field, std::size_t index) {
  const std::uint64_t raw = BigEndian(message.data() + field.offset + index * field.width, field.width);
  if (field.type == "byte") return static_cast<std::int64_t>(raw);
  const int unused_bits = 64 - 8 * static_cast<int>(field.width);
  return static_cast<std::int64_t>(raw << unused_bits) >> unused_bits;  // keeps the sign
}

double NumberAt(std::span<const std::uint8_t> message, const MessageField& field, std::size_t index) {
  const std::uint64_t raw = BigEndian(message.data() + field.offset + index * field.width, field.width);
  if (field.type == "double") return std::bit_cast<double>(raw);
  if (field.type == "float") return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(raw)));
  return static_cast<double>(IntegerAt(message, field, index));
}

std::string TextAt(std::span<const std::uint8_t> message, const MessageField& field, std::size_t row) {
  const auto length = static_cast<std::size_t>(field.dims.back());
  const std::uint8_t* bytes = message.data() + field.offset + row * length;
  std::string text;
  for (std::size_t i = 0; i < length && bytes[i] != 0; ++i)
    text.push_back(bytes[i] > ' ' - 1 && bytes[i] < 0x7f ? static_cast<char>(bytes[i]) : '?');
  return text;
}

}  // namespace armcmc::log_export
