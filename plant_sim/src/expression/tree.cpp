#include "armcmc/plant_sim/expression/tree.hpp"

#include <array>
#include <cctype>
#include <charconv>
#include <cstddef>
#include <initializer_list>
#include <utility>

namespace armcmc::plant_sim::expression {
namespace {

struct Function {
  std::string_view name;
  std::size_t arguments;
};
constexpr std::array kFunctions = {
    Function{"abs", 1},   Function{"sign", 1},     Function{"sqrt", 1},     Function{"exp", 1},
    Function{"log", 1},   Function{"log2", 1},     Function{"log10", 1},    Function{"sin", 1},
    Function{"cos", 1},   Function{"tan", 1},      Function{"asin", 1},     Function{"acos", 1},
    Function{"atan", 1},  Function{"tanh", 1},     Function{"min", 2},      Function{"max", 2},
    Function{"clamp", 3}, Function{"step", 1},     Function{"if", 3},       Function{"lowpass", 2},
    Function{"delay", 2}, Function{"integral", 1}, Function{"previous", 1}, Function{"elapsed", 0}};

constexpr int kDeepest = 200;  // calls of the parser that stand open

bool IsLetter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool IsDigit(char c) { return c >= '0' && c <= '9'; }

class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) { Advance(); }

  Tree Whole() {
    Tree tree = Or();
    if (!token_.empty()) Fail("expected an operator or the end");
    return tree;
  }

 private:
  [[noreturn]] void Fail(const std::string& expected) const {
    const std::string found = token_.empty() ? "the end" : '"' + std::string(token_) + '"';
    throw Error(column(), "found " + found + ", " + expected);
  }
  [[nodiscard]] int column() const { return static_cast<int>(begin_) + 1; }

  void Advance() {
    while (end_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[end_])) != 0) ++end_;
    begin_ = end_;
    if (end_ == text_.size()) {
      token_ = {};
      return;
    }
    const char c = text_[end_++];
    const char next = end_ < text_.size() ? text_[end_] : '\0';
    if (IsLetter(c)) {
      while (end_ < text_.size() && (IsLetter(text_[end_]) || IsDigit(text_[end_]))) ++end_;
    } else if (IsDigit(c) || (c == '.' && IsDigit(next))) {
      const auto [stop, error] = std::from_chars(text_.data() + begin_, text_.data() + text_.size(), number_);
      end_ = static_cast<std::size_t>(stop - text_.data());
      token_ = text_.substr(begin_, end_ - begin_);
      if (error != std::errc()) Fail("expected a number that a double can hold");
    } else if ((c == '<' || c == '>' || c == '=' || c == '!') && next == '=') {
      ++end_;
    }
    token_ = text_.substr(begin_, end_ - begin_);
  }

  bool IsAnyOf(std::initializer_list<std::string_view> words) const {
    for (const std::string_view word : words)
      if (token_ == word) return true;
    return false;
  }
  void Expect(std::string_view token) {
    if (token_ != token) Fail("expected \"" + std::string(token) + '"');
    Advance();
  }
  Tree Operator(std::string_view text, int column, std::vector<Tree> arguments) const {
    Tree tree;
    tree.kind = Kind::kOperator;
    tree.text = text;
    tree.column = column;
    tree.arguments = std::move(arguments);
    return tree;
  }

  /// Left associative.
  Tree Chain(Tree (Parser::*part)(), std::initializer_list<std::string_view> signs) {
    Tree left = (this->*part)();
    while (IsAnyOf(signs)) left = Pair(std::move(left), part);
    return left;
  }
  Tree Pair(Tree left, Tree (Parser::*part)()) {
    const std::string_view sign = token_;
    const int at = column();
    Advance();
    std::vector<Tree> both;
    both.push_back(std::move(left));
    both.push_back((this->*part)());
    return Operator(sign, at, std::move(both));
  }

  Tree Or() { return Chain(&Parser::And, {"or"}); }
  Tree And() { return Chain(&Parser::Not, {"and"}); }
  Tree Not() {
    if (token_ != "not") return Relation();
    return Prefix("not", &Parser::Not);
  }
  Tree Relation() {
    Tree left = Sum();
    if (!IsAnyOf({"<", "<=", ">", ">=", "==", "!="})) return left;
    left = Pair(std::move(left), &Parser::Sum);
    if (IsAnyOf({"<", "<=", ">", ">=", "==", "!="})) Fail("expected \"and\" between two comparisons");
    return left;
  }
  Tree Sum() { return Chain(&Parser::Product, {"+", "-"}); }
  Tree Product() { return Chain(&Parser::Signed, {"*", "/"}); }
  Tree Signed() {
    if (token_ == "-") return Prefix("neg", &Parser::Signed);
    if (token_ == "+") {
      Advance();
      return Deeper(&Parser::Signed);
    }
    Tree base = Atom();
    if (token_ != "^") return base;
    return Pair(std::move(base), &Parser::Signed);  // right associative: 2^-3^2 = 2^(-(3^2))
  }
  Tree Prefix(std::string_view text, Tree (Parser::*part)()) {
    const int at = column();
    Advance();
    std::vector<Tree> one;
    one.push_back(Deeper(part));
    return Operator(text, at, std::move(one));
  }
  Tree Deeper(Tree (Parser::*part)()) {
    if (++depth_ > kDeepest) Fail("which is nested too deeply");
    Tree tree = (this->*part)();
    --depth_;
    return tree;
  }

  Tree Atom() {
    if (token_.empty()) Fail("expected a number, a name or \"(\"");
    if (token_ == "(") {
      Advance();
      Tree inside = Deeper(&Parser::Or);
      Expect(")");
      return inside;
    }
    Tree tree;
    tree.column = column();
    tree.text = token_;
    if (IsDigit(token_.front()) || token_.front() == '.') {
      tree.number = number_;
      Advance();
      return tree;
    }
    if (!IsLetter(token_.front()) || IsAnyOf({"and", "or", "not"})) Fail("expected a number, a name or \"(\"");
    Advance();
    tree.kind = Kind::kName;
    if (token_ == "(") Call(&tree);
    return tree;
  }

  void Call(Tree* tree) {
    tree->kind = Kind::kFunction;
    const Function* function = nullptr;
    for (const Function& known : kFunctions)
      if (known.name == tree->text) function = &known;
    if (function == nullptr) throw Error(tree->column, "unknown function \"" + tree->text + '"');
    Advance();
    while (token_ != ")") {
      if (!tree->arguments.empty()) Expect(",");
      tree->arguments.push_back(Deeper(&Parser::Or));
    }
    Advance();
    if (tree->arguments.size() != function->arguments)
      throw Error(tree->column, tree->text + " takes " + std::to_string(function->arguments) + " arguments, not " +
                                    std::to_string(tree->arguments.size()));
  }

  std::string_view text_, token_;
  std::size_t begin_ = 0, end_ = 0;
  double number_ = 0.0;
  int depth_ = 0;
};

}  // namespace

Tree Parse(std::string_view text) { return Parser(text).Whole(); }

bool HasMemory(const Tree& node) {
  if (node.kind != Kind::kFunction) return false;
  for (const std::string_view name : {"lowpass", "delay", "integral", "previous", "elapsed"})
    if (node.text == name) return true;
  return false;
}

}  // namespace armcmc::plant_sim::expression
