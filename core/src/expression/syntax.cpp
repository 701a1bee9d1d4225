#include "armcmc/expression/syntax.hpp"

#include <algorithm>
#include <charconv>
#include <optional>

namespace armcmc::expression {
namespace {

bool IsLetter(char c) noexcept { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool IsDigit(char c) noexcept { return c >= '0' && c <= '9'; }
bool IsBlank(char c) noexcept { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

std::optional<Op> FunctionOf(std::string_view name) noexcept {
  for (std::size_t op = 0; op < kOps.size(); ++op)
    if (kOps[op].function && kOps[op].name == name) return static_cast<Op>(op);
  return std::nullopt;
}

bool IsWord(std::string_view name) noexcept { return name == "and" || name == "or" || name == "not"; }

enum class TokenKind { kNumber, kName, kSign, kEnd };

struct Token {
  TokenKind kind = TokenKind::kEnd;
  std::string_view text;
  int column = 1;
  double value = 0.0;

  [[nodiscard]] bool Is(std::string_view sign) const noexcept {
    return (kind == TokenKind::kSign || kind == TokenKind::kName) && text == sign;
  }
  [[nodiscard]] std::string Shown() const {
    return kind == TokenKind::kEnd ? std::string("the end") : '"' + std::string(text) + '"';
  }
};

class Lexer {
 public:
  explicit Lexer(std::string_view text) : text_(text) {}

  Token Next() {
    while (at_ < text_.size() && IsBlank(text_[at_])) ++at_;
    Token token;
    token.column = static_cast<int>(at_) + 1;
    if (at_ == text_.size()) return token;
    const char c = text_[at_];
    if (IsDigit(c) || (c == '.' && at_ + 1 < text_.size() && IsDigit(text_[at_ + 1]))) return Number(token);
    if (IsLetter(c)) {
      std::size_t end = at_;
      while (end < text_.size() && (IsLetter(text_[end]) || IsDigit(text_[end]))) ++end;
      return Take(token, TokenKind::kName, end - at_);
    }
    for (const std::string_view sign : {"<=", ">=", "==", "!="})
      if (text_.substr(at_, 2) == sign) return Take(token, TokenKind::kSign, 2);
    if (std::string_view("+-*/^()<>,").find(c) != std::string_view::npos) return Take(token, TokenKind::kSign, 1);
    const bool printable = c > ' ' && c <= '~';
    std::string what = printable ? std::string("'") + c + "' is not allowed in an expression"
                                 : std::string("a character that is not allowed in an expression");
    if (c == '=') what += ": equality is ==";
    if (c == '&') what += ": write and";
    if (c == '|') what += ": write or, or abs(x) for the absolute value";
    if (c == '!') what += ": write not";
    throw Error(token.column, what);
  }

 private:
  Token Take(Token token, TokenKind kind, std::size_t length) {
    token.kind = kind;
    token.text = text_.substr(at_, length);
    at_ += length;
    return token;
  }

  Token Number(Token token) {
    const char* first = text_.data() + at_;
    const char* last = text_.data() + text_.size();
    const auto [end, error] = std::from_chars(first, last, token.value);
    if (error == std::errc::result_out_of_range) throw Error(token.column, "a number beyond the range of doubles");
    if (error != std::errc{}) throw Error(token.column, "a number that cannot be read");
    if (end != last && (IsLetter(*end) || *end == '.'))
      throw Error(static_cast<int>(end - text_.data()) + 1,
                  "a number runs into a name: write " + std::string(first, static_cast<std::size_t>(end - first)) +
                      "*name for a product");
    return Take(token, TokenKind::kNumber, static_cast<std::size_t>(end - first));
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

class Parser {
 public:
  explicit Parser(std::string_view text) : lexer_(text), token_(lexer_.Next()) {}

  Syntax Whole() {
    if (token_.kind == TokenKind::kEnd) throw Error(1, "the expression is empty");
    Or();
    if (token_.kind == TokenKind::kEnd) return std::move(syntax_);
    if (token_.Is(")")) throw Error(token_.column, "\")\" without \"(\" before it");
    if (token_.kind != TokenKind::kSign || token_.Is("("))
      throw Error(token_.column,
                  "expected an operator before " + token_.Shown() + "; a product is written with *" + UnitHint());
    throw Error(token_.column, "expected the end, found " + token_.Shown());
  }

 private:
  /// Bounds the recursion.
  class Nesting {
   public:
    Nesting(int* depth, int column) : depth_(depth) {
      if (++*depth_ > kMaxNesting)
        throw Error(column, "nested more than " + std::to_string(kMaxNesting) + " deep: name a part of it");
    }
    ~Nesting() { --*depth_; }
    Nesting(const Nesting&) = delete;
    Nesting& operator=(const Nesting&) = delete;

   private:
    int* depth_;
  };

  void Advance() {
    before_ = token_;
    token_ = lexer_.Next();
  }

  /// How to write what seems to be a number with a unit behind it.
  [[nodiscard]] std::string UnitHint() const {
    if (before_.kind != TokenKind::kNumber || token_.kind != TokenKind::kName) return "";
    return "; a number with a unit needs a name: [constants] NAME = { value = " + std::string(before_.text) +
           ", unit = \"..\" }";
  }

  int Add(Op op, int column, std::array<int, kMaxArguments> argument = {-1, -1, -1}) {
    SyntaxNode node;
    node.op = op;
    node.argument = argument;
    node.column = column;
    syntax_.nodes.push_back(std::move(node));
    return syntax_.root();
  }

  int Or() {
    int left = And();
    while (token_.Is("or")) {
      const int column = token_.column;
      Advance();
      const int right = And();
      left = Add(Op::kOr, column, {left, right, -1});
    }
    return left;
  }

  int And() {
    int left = Not();
    while (token_.Is("and")) {
      const int column = token_.column;
      Advance();
      const int right = Not();
      left = Add(Op::kAnd, column, {left, right, -1});
    }
    return left;
  }

  int Not() {
    if (!token_.Is("not")) return Relation();
    const int column = token_.column;
    const Nesting nesting(&depth_, column);
    Advance();
    const int operand = Not();
    return Add(Op::kNot, column, {operand, -1, -1});
  }

  [[nodiscard]] bool AtRelation() const noexcept {
    return token_.Is("<") || token_.Is("<=") || token_.Is(">") || token_.Is(">=") || token_.Is("==") || token_.Is("!=");
  }

  int Relation() {
    const int left = Sum();
    if (!AtRelation()) return left;
    const Token sign = token_;
    Advance();
    const int right = Sum();
    if (AtRelation()) throw Error(token_.column, "two comparisons in a row: write a < b and b < c");
    if (sign.Is(">")) return Add(Op::kLess, sign.column, {right, left, -1});
    if (sign.Is(">=")) return Add(Op::kLessEqual, sign.column, {right, left, -1});
    const Op op = sign.Is("<")    ? Op::kLess
                  : sign.Is("<=") ? Op::kLessEqual
                  : sign.Is("==") ? Op::kEqual
                                  : Op::kNotEqual;
    return Add(op, sign.column, {left, right, -1});
  }

  int Sum() {
    int left = Product();
    while (token_.Is("+") || token_.Is("-")) {
      const Token sign = token_;
      Advance();
      const int right = Product();
      left = Add(sign.Is("+") ? Op::kAdd : Op::kSubtract, sign.column, {left, right, -1});
    }
    return left;
  }

  int Product() {
    int left = Signed();
    while (token_.Is("*") || token_.Is("/")) {
      const Token sign = token_;
      Advance();
      if (token_.Is("*")) throw Error(sign.column, "a power is written with ^");
      const int right = Signed();
      left = Add(sign.Is("*") ? Op::kMultiply : Op::kDivide, sign.column, {left, right, -1});
    }
    return left;
  }

  int Signed() {
    if (!token_.Is("-") && !token_.Is("+")) return Power();
    const Token sign = token_;
    const Nesting nesting(&depth_, sign.column);
    Advance();
    const int operand = Signed();
    return sign.Is("+") ? operand : Add(Op::kNegate, sign.column, {operand, -1, -1});
  }

  int Power() {
    const int base = Atom();
    if (!token_.Is("^")) return base;
    const int column = token_.column;
    const Nesting nesting(&depth_, column);
    Advance();
    const int exponent = Signed();
    return Add(Op::kPower, column, {base, exponent, -1});
  }

  int Atom() {
    const Token token = token_;
    if (token.kind == TokenKind::kNumber) {
      Advance();
      const int node = Add(Op::kNumber, token.column);
      syntax_.nodes.back().value = token.value;
      return node;
    }
    if (token.Is("(")) {
      const Nesting nesting(&depth_, token.column);
      Advance();
      const int inside = Or();
      if (!token_.Is(")")) throw Error(token_.column, Expected(")", token));
      Advance();
      return inside;
    }
    if (token.kind != TokenKind::kName || IsWord(token.text))
      throw Error(token.column, "expected a number, a name or \"(\", found " + token.Shown());
    Advance();
    if (token_.Is("(")) return Call(token);
    if (FunctionOf(token.text))
      throw Error(token.column, std::string(token.text) + " is a function: write " + std::string(token.text) + "(...)");
    const int node = Add(Op::kSymbol, token.column);
    syntax_.nodes.back().name = token.text;
    return node;
  }

  int Call(const Token& name) {
    const std::optional<Op> op = FunctionOf(name.text);
    if (!op) throw UnknownName(name.column, name.text, "function");
    const Token open = token_;
    const Nesting nesting(&depth_, open.column);
    Advance();
    std::array<int, kMaxArguments> argument{-1, -1, -1};
    int count = 0;
    while (!token_.Is(")")) {
      if (count > 0) {
        if (!token_.Is(",")) throw Error(token_.column, Expected("\",\" or \")", open));
        Advance();
      }
      const int column = token_.column;
      const int value = Or();
      if (count == kMaxArguments) throw Error(column, WrongCount(name.text, *op, "more"));
      argument[static_cast<std::size_t>(count++)] = value;
    }
    if (count != InfoOf(*op).arguments) throw Error(name.column, WrongCount(name.text, *op, std::to_string(count)));
    Advance();
    return Add(*op, name.column, argument);
  }

  [[nodiscard]] std::string Expected(std::string_view what, const Token& open) const {
    return "expected \"" + std::string(what) + "\" to close \"(\" of column " + std::to_string(open.column) +
           ", found " + token_.Shown() + UnitHint();
  }

  static std::string WrongCount(std::string_view name, Op op, const std::string& found) {
    const int wanted = InfoOf(op).arguments;
    return std::string(name) + " takes " +
           (wanted == 0 ? std::string("no argument")
                        : std::to_string(wanted) + (wanted == 1 ? " argument" : " arguments")) +
           ", found " + found;
  }

  Lexer lexer_;
  Token before_, token_;
  Syntax syntax_;
  int depth_ = 0;
};

}  // namespace

int Syntax::FirstColumn(int node) const {
  int first = at(node).column;
  for (const int argument : at(node).argument)
    if (argument >= 0) first = std::min(first, FirstColumn(argument));
  return first;
}

Syntax Parse(std::string_view text) {
  if (text.size() > static_cast<std::size_t>(kMaxTextLength))
    throw Error(kMaxTextLength + 1, "longer than " + std::to_string(kMaxTextLength) + " characters");
  return Parser(text).Whole();
}

bool IsFreeName(std::string_view name) noexcept {
  return !name.empty() && IsLetter(name.front()) &&
         std::all_of(name.begin(), name.end(), [](char c) { return IsLetter(c) || IsDigit(c); }) && !IsWord(name) &&
         !FunctionOf(name);
}

}  // namespace armcmc::expression
