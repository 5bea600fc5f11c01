// Formulas: muParser compiles them, and what it has compiled is worked off here for several particles at a time, so
// that each instruction is looked at once for all of them (muParser's own bulk mode starts threads). Called from module
// sgmp_expression, which says what each function is for. Every operation is muParser's, in its order, so that the
// bits are those of mu::Parser::Eval.
#include <muParser.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <string>
#include <vector>

namespace {

const int lanes = 8;      // particles at a time: those of sgmp_kinds
const int variables = 7;  // of sgmp_expression

// Rows of a table that formulas call as a function: arguments ascend.
struct Table {
  std::vector<double> arguments, values;
};

// A text compiled by muParser, and the places of its variables: all lanes of the first, then of the next.
struct Formula {
  mu::Parser parser;
  std::deque<Table> tables;  // whose addresses the parser keeps
  double places[variables*lanes] = {};
  std::vector<double> stack;  // of values of all lanes
  bool known = false;         // whether `work` knows all instructions
};

using Token = mu::SToken;

// A table between its rows: linear; before the first and behind the last: constant.
double table_value(void *data, double argument)
{
  const Table &table = *static_cast<Table *>(data);
  if (std::isnan(argument)) return argument;
  const auto above = std::upper_bound(table.arguments.begin(), table.arguments.end(), argument);
  if (above == table.arguments.begin()) return table.values.front();
  if (above == table.arguments.end()) return table.values.back();
  const auto i = above - table.arguments.begin();
  const double part = (argument - table.arguments[i - 1])/(table.arguments[i] - table.arguments[i - 1]);
  return table.values[i - 1] + part*(table.values[i] - table.values[i - 1]);
}

// Whether `work` knows an instruction.
bool knows(const Token &token)
{
  switch (token.Cmd) {
  case mu::cmFUNC: return token.Fun.argc != 0 && token.Fun.argc <= 2;
  case mu::cmLE: case mu::cmGE: case mu::cmNEQ: case mu::cmEQ: case mu::cmLT: case mu::cmGT:
  case mu::cmADD: case mu::cmSUB: case mu::cmMUL: case mu::cmDIV: case mu::cmPOW: case mu::cmLAND: case mu::cmLOR:
  case mu::cmIF: case mu::cmELSE: case mu::cmENDIF: case mu::cmVAR: case mu::cmVAL:
  case mu::cmVARPOW2: case mu::cmVARPOW3: case mu::cmVARPOW4: case mu::cmVARMUL: case mu::cmEND: return true;
  default: return false;
  }
}

// a = f(a, b) in n lanes.
template <class F> void two(double *a, int n, F f)
{
  const double *b = a + lanes;
  for (int l = 0; l < n; l++) a[l] = f(a[l], b[l]);
}

// a = f(variable) in n lanes, which stand at `lane`.
template <class F> void one(double *a, const Token &token, const int *lane, int n, F f)
{
  for (int l = 0; l < n; l++) a[l] = f(token.Val.ptr[lane[l]]);
}

// The formula in n lanes: values[lane[l]].
void work(Formula &formula, const int *lane, int n, double *values)
{
  double *top = formula.stack.data();  // entry 0 is never used, as in muParser
  for (const Token *token = formula.parser.GetByteCode().GetBase(); token->Cmd != mu::cmEND; token++) {
    switch (token->Cmd) {
    case mu::cmLE: top -= lanes; two(top, n, [](double a, double b) { return double(a <= b); }); break;
    case mu::cmGE: top -= lanes; two(top, n, [](double a, double b) { return double(a >= b); }); break;
    case mu::cmNEQ: top -= lanes; two(top, n, [](double a, double b) { return double(a != b); }); break;
    case mu::cmEQ: top -= lanes; two(top, n, [](double a, double b) { return double(a == b); }); break;
    case mu::cmLT: top -= lanes; two(top, n, [](double a, double b) { return double(a < b); }); break;
    case mu::cmGT: top -= lanes; two(top, n, [](double a, double b) { return double(a > b); }); break;
    case mu::cmADD: top -= lanes; two(top, n, [](double a, double b) { return a + b; }); break;
    case mu::cmSUB: top -= lanes; two(top, n, [](double a, double b) { return a - b; }); break;
    case mu::cmMUL: top -= lanes; two(top, n, [](double a, double b) { return a*b; }); break;
    case mu::cmDIV: top -= lanes; two(top, n, [](double a, double b) { return a/b; }); break;
    case mu::cmPOW: top -= lanes; two(top, n, [](double a, double b) { return std::pow(a, b); }); break;
    case mu::cmLAND: top -= lanes; two(top, n, [](double a, double b) { return double(a && b); }); break;
    case mu::cmLOR: top -= lanes; two(top, n, [](double a, double b) { return double(a || b); }); break;
    case mu::cmVAR: top += lanes; one(top, *token, lane, n, [](double v) { return v; }); break;
    case mu::cmVARPOW2: top += lanes; one(top, *token, lane, n, [](double v) { return v*v; }); break;
    case mu::cmVARPOW3: top += lanes; one(top, *token, lane, n, [](double v) { return v*v*v; }); break;
    case mu::cmVARPOW4: top += lanes; one(top, *token, lane, n, [](double v) { return v*v*v*v; }); break;
    case mu::cmVARMUL:
      top += lanes;
      one(top, *token, lane, n, [token](double v) { return v*token->Val.data + token->Val.data2; });
      break;
    case mu::cmVAL:
      top += lanes;
      for (int l = 0; l < n; l++) top[l] = token->Val.data2;
      break;
    case mu::cmFUNC:
      if (token->Fun.argc == 1) {
        for (int l = 0; l < n; l++) top[l] = token->Fun.cb.call_fun<1>(top[l]);
      } else if (token->Fun.argc == 2) {
        top -= lanes;
        two(top, n, [token](double a, double b) { return token->Fun.cb.call_fun<2>(a, b); });
      } else {  // any number of arguments
        const int count = -token->Fun.argc;
        std::vector<double> arguments(count);
        top -= (count - 1)*lanes;
        for (int l = 0; l < n; l++) {
          for (int i = 0; i < count; i++) arguments[i] = top[i*lanes + l];
          top[l] = token->Fun.cb.call_multfun(arguments.data(), count);
        }
      }
      break;
    case mu::cmIF: {
      int yes[lanes], no[lanes], some = 0, others = 0;
      for (int l = 0; l < n; l++) (top[l] != 0 ? yes[some++] : no[others++]) = lane[l];
      if (some > 0 && others > 0) {  // each part from the start
        work(formula, yes, some, values);
        work(formula, no, others, values);
        return;
      }
      if (some == 0) token += token->Oprt.offset;
      top -= lanes;
      break;
    }
    case mu::cmELSE: token += token->Oprt.offset; break;
    default: break;  // cmENDIF
    }
  }
  for (int l = 0; l < n; l++) values[lane[l]] = top[l];
}

Formula &formula_of(void *handle) { return *static_cast<Formula *>(handle); }

void put_text(const std::string &text, char *place, int length)
{
  const int n = std::min(length, static_cast<int>(text.size()));
  std::memcpy(place, text.data(), n);
  std::memset(place + n, ' ', length - n);
}

} // namespace

extern "C" {

void *sgmp_formula_make() { return new Formula; }

void sgmp_formula_free(void *handle) { delete &formula_of(handle); }

void sgmp_formula_variable(void *handle, const char *name, int number)
{
  Formula &formula = formula_of(handle);
  formula.parser.DefineVar(name, formula.places + lanes*(number - 1));
}

void sgmp_formula_constant(void *handle, const char *name, double value)
{
  try {
    formula_of(handle).parser.DefineConst(name, value);
  } catch (const mu::ParserError &) {
    // a name that muParser cannot use is one that no formula can
  }
}

void sgmp_formula_table(void *handle, const char *name, const double *rows, int count)
{
  Formula &formula = formula_of(handle);
  Table &table = formula.tables.emplace_back();
  for (int i = 0; i < count; i++) {
    table.arguments.push_back(rows[2*i]);
    table.values.push_back(rows[2*i + 1]);
  }
  formula.parser.DefineFunUserData(name, table_value, &table);
}

int sgmp_formula_compile(void *handle, const char *text, double *value, char *message, int message_length,
                         char *token, int token_length, int *position)
{
  Formula &formula = formula_of(handle);
  *value = 0;
  *position = 1;
  try {
    formula.parser.SetExpr(text);
    int count = 0;
    const double *values = formula.parser.Eval(count);
    *value = values[0];
    const mu::ParserByteCode &code = formula.parser.GetByteCode();
    formula.stack.resize(lanes*(code.GetMaxStackSize() + 1));
    if (std::any_of(code.GetBase(), code.GetBase() + code.GetSize(),
                    [](const Token &part) { return part.Cmd == mu::cmASSIGN; })) {
      put_text("a formula assigns nothing: write == to compare", message, message_length);
      put_text("=", token, token_length);
      return 0;
    }
    formula.known = std::all_of(code.GetBase(), code.GetBase() + code.GetSize(), knows);
    return count;
  } catch (const mu::ParserError &error) {
    put_text(error.GetMsg(), message, message_length);
    put_text(error.GetToken(), token, token_length);
    *position = static_cast<int>(error.GetPos()) + 1;
    return 0;
  }
}

int sgmp_formula_uses(void *handle, int number)
{
  const Formula &formula = formula_of(handle);
  for (const auto &used : formula.parser.GetUsedVar()) {
    if (used.second == formula.places + lanes*(number - 1)) return 1;
  }
  return 0;
}

void sgmp_formula_values(void *handle, const double *places, const int *lane, int n, double *values)
{
  Formula &formula = formula_of(handle);
  std::memcpy(formula.places, places, sizeof formula.places);
  if (formula.known) {
    work(formula, lane, n, values);
    return;
  }
  for (int l = 0; l < n; l++) {
    for (int v = 0; v < variables; v++) formula.places[v*lanes] = places[v*lanes + lane[l]];
    values[lane[l]] = formula.parser.Eval();
  }
}
}
