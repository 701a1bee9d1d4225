#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace armcmc::plots {

/// Text as UTF-8: what is none (a file name in another encoding) becomes U+FFFD.
[[nodiscard]] std::string ValidUtf8(std::string_view text);

/// Text for the content or a quoted attribute of an element: valid UTF-8 without < > & " ' and without control
/// characters other than tab and line end.
[[nodiscard]] std::string EscapeHtml(std::string_view text);

/// JSON for the inside of a <script> element, which no content can end: < > & are escaped. Not finite becomes null.
[[nodiscard]] std::string ScriptJson(const nlohmann::json& value);

/// A number for people: so many significant digits, a real minus, "1.2 × 10⁻⁵" where zeros would have to be counted,
/// "–" when it is not finite.
[[nodiscard]] std::string NumberText(double value, int digits);

/// The same with so many digits after the point.
[[nodiscard]] std::string FixedText(double value, int decimals);

/// A share of one in percent with one digit after the point: "99.1 %". Never certain: "> 99.9 %", "< 0.1 %". "–" when
/// not finite.
[[nodiscard]] std::string PercentText(double share);

}  // namespace armcmc::plots
