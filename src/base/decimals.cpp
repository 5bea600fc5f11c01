// Numbers as decimal text, some ten times as fast as a formatted WRITE. Called from module sgmp_decimals, which says
// what each function is for. std::to_chars rounds as printf does, so the text is that of es24.16e3 without blanks.
#include <charconv>
#include <cmath>
#include <cstring>

namespace {

const int digits = 16; // behind the point: 17 significant ones restore every bit

char *put_word(char *at, const char *word)
{
  const auto length = std::strlen(word);
  std::memcpy(at, word, length);
  return at + length;
}

char *put_real(char *at, double value)
{
  if (std::isnan(value)) return put_word(at, "NaN");
  if (std::isinf(value)) return put_word(at, value > 0 ? "Infinity" : "-Infinity");
  char *end = std::to_chars(at, at + 32, value, std::chars_format::scientific, digits).ptr;
  char *exponent = end - 1; // e+05 or e-300 becomes E+005 or E-300
  while (*exponent != 'e') exponent--;
  *exponent = 'E';
  if (end - exponent == 4) {
    std::memmove(exponent + 3, exponent + 2, 2);
    exponent[2] = '0';
    end++;
  }
  return end;
}

} // namespace

extern "C" {

void sgmp_reals_put(const double *values, int n, const char *separator, char *text, int *length)
{
  char *at = text;
  for (int i = 0; i < n; i++) {
    if (i > 0) *at++ = *separator;
    at = put_real(at, values[i]);
  }
  *length = static_cast<int>(at - text);
}

void sgmp_integer_put(long long value, char *text, int *length)
{
  *length = static_cast<int>(std::to_chars(text, text + 24, value).ptr - text);
}
}
