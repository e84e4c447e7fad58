// osg.Matrix: 4 x 4, row vectors from the left (v * M), translation in the last row; A * B applies A first.
#include <cmath>

#include "engine/script/script_state.hpp"
#include "engine/script/values.hpp"

namespace verisim::script {
namespace {

Matrix matrix_of(const Pose& pose) {
  Matrix M = Matrix::Identity();
  M.topLeftCorner<3, 3>() = pose.rotation.toRotationMatrix().transpose();
  M.row(3).head<3>() = pose.position.transpose();
  return M;
}

Matrix& self(lua_State* L) {
  return get<Matrix>(L, 1, "what a matrix's word is called on");
}

int push_matrix(lua_State* L, const Matrix& M) {
  push(L, Matrix(M));
  return 1;
}

Vector3d transformed(const Vector3d& v, const Matrix& M) {
  const Eigen::RowVector4d product = Eigen::RowVector4d(v.x(), v.y(), v.z(), 1) * M;
  return product.head<3>().transpose() / product[3];
}

// Three numbers or a vector, from argument `first` on.
Vector3d vector_argument(lua_State* L, int first, const char* what) {
  if (lua_gettop(L) >= first + 2)
    return {number_at(L, first, what), number_at(L, first + 1, what), number_at(L, first + 2, what)};
  return vector_at(L, first, what);
}

// A rotation, or an angle and an axis.
Quaterniond rotation_argument(lua_State* L, int first, const char* what) {
  if (lua_type(L, first) != LUA_TNUMBER) return rotation_at(L, first, what);
  const Vector3d axis = vector_at(L, first + 1, what);
  const double length = std::sqrt(axis.squaredNorm());
  if (!(length > 0)) raise(L, "{}: the axis has no direction", what);
  return rotation_from_vector(axis * (number_at(L, first, what) / length));
}

Matrix translation(const Vector3d& v) {
  return matrix_of({v, Quaterniond::Identity()});
}
Matrix rotation(const Quaterniond& q) {
  return matrix_of({Vector3d::Zero(), q});
}
Matrix scaling(const Vector3d& s) {
  Matrix M = Matrix::Identity();
  M.diagonal().head<3>() = s;
  return M;
}

int make_matrix(lua_State* L) {
  if (lua_gettop(L) == 0) return push_matrix(L, Matrix::Identity());
  if (const Matrix* other = get_if<Matrix>(L, 1)) return push_matrix(L, *other);
  if (lua_gettop(L) != 16) return push_matrix(L, rotation(rotation_argument(L, 1, "osg.Matrix: the rotation")));
  Matrix M;
  for (int i = 0; i < 16; ++i) M(i / 4, i % 4) = number_at(L, i + 1, fmt::format("osg.Matrix: element {}", i + 1));
  return push_matrix(L, M);
}

int identity(lua_State* L) {
  return push_matrix(L, Matrix::Identity());
}
int translate(lua_State* L) {
  return push_matrix(L, translation(vector_argument(L, 1, "osg.Matrix.translate")));
}
int rotate(lua_State* L) {
  return push_matrix(L, rotation(rotation_argument(L, 1, "osg.Matrix.rotate")));
}
int scale(lua_State* L) {
  return push_matrix(L, scaling(vector_argument(L, 1, "osg.Matrix.scale")));
}

int make_translate(lua_State* L) {
  self(L) = translation(vector_argument(L, 2, "makeTranslate"));
  return 0;
}
int make_rotate(lua_State* L) {
  self(L) = rotation(rotation_argument(L, 2, "makeRotate"));
  return 0;
}
int make_scale(lua_State* L) {
  self(L) = scaling(vector_argument(L, 2, "makeScale"));
  return 0;
}
int make_identity(lua_State* L) {
  self(L) = Matrix::Identity();
  return 0;
}

int set_translation(lua_State* L) {
  self(L).row(3).head<3>() = vector_argument(L, 2, "setTrans").transpose();
  return 0;
}
int get_translation(lua_State* L) {
  push(L, Vector3d(self(L).row(3).head<3>().transpose()));
  return 1;
}
int get_rotation(lua_State* L) {
  push(L, Quaterniond(pose_of_matrix(L, self(L), "getRotate: the matrix").rotation));
  return 1;
}
int get_scale(lua_State* L) {
  push(L, Vector3d(self(L).topLeftCorner<3, 3>().rowwise().norm()));
  return 1;
}

// M:preMult(v) = v * M; M:preMult(A) sets M = A * M. postMult the other way round.
int pre_multiply(lua_State* L) {
  Matrix& M = self(L);
  if (const Matrix* A = get_if<Matrix>(L, 2)) {
    M = (*A * M).eval();
    return 0;
  }
  push(L, transformed(vector_at(L, 2, "preMult: the vector"), M));
  return 1;
}

int post_multiply(lua_State* L) {
  Matrix& M = self(L);
  if (const Matrix* A = get_if<Matrix>(L, 2)) {
    M = (M * *A).eval();
    return 0;
  }
  push(L, transformed(vector_at(L, 2, "postMult: the vector"), Matrix(M.transpose())));
  return 1;
}

int set_product(lua_State* L) {
  const Matrix product = get<Matrix>(L, 2, "mult: the left matrix") * get<Matrix>(L, 3, "mult: the right matrix");
  self(L) = product;
  return 0;
}

int multiply(lua_State* L) {
  const Matrix& A = get<Matrix>(L, 1, "the left side of '*'");
  if (const Matrix* B = get_if<Matrix>(L, 2)) return push_matrix(L, A * *B);
  push(L, transformed(vector_at(L, 2, "the right side of '*'"), Matrix(A.transpose())));
  return 1;
}

Matrix inverse_of(lua_State* L, const Matrix& M) {
  const double determinant = M.determinant();
  if (!(std::abs(determinant) > 0)) raise(L, "the matrix has no inverse");
  return M.inverse();
}
int inverse(lua_State* L) {
  return push_matrix(L, inverse_of(L, self(L)));
}
int invert(lua_State* L) {
  Matrix& M = self(L);
  M = inverse_of(L, lua_gettop(L) > 1 ? get<Matrix>(L, 2, "invert: the matrix") : M);
  lua_pushboolean(L, 1);
  return 1;
}

// M(row, column), from 0 as in OpenSceneGraph.
int element(lua_State* L) {
  const Matrix& M = self(L);
  const double row = number_at(L, 2, "a matrix's row"), column = number_at(L, 3, "a matrix's column");
  if (!(row >= 0 && row < 4 && column >= 0 && column < 4)) raise(L, "a matrix has rows and columns 0 to 3");
  lua_pushnumber(L, M(static_cast<int>(row), static_cast<int>(column)));
  return 1;
}

int matrix_text(lua_State* L) {
  const Matrix& M = self(L);
  std::string text;
  for (int i = 0; i < 16; ++i) text += fmt::format("{}{:g}", i == 0 ? "" : i % 4 == 0 ? "; " : ", ", M(i / 4, i % 4));
  push_text(L, "[" + text + "]");
  return 1;
}

int matrices_equal(lua_State* L) {
  lua_pushboolean(L, self(L) == get<Matrix>(L, 2, "a side of '=='") ? 1 : 0);
  return 1;
}

int called(lua_State* L) {                  // osg.Matrix(…): the table of static functions is called
  if (lua_gettop(L) > 0) lua_remove(L, 1);  // its metamethod can be called without anything
  return make_matrix(L);
}

}  // namespace

void push_matrix_of(lua_State* L, const Pose& pose) {
  push(L, matrix_of(pose));
}

Pose pose_of_matrix(lua_State* L, const Matrix& matrix, const std::string& what) {
  Matrix3d R = matrix.topLeftCorner<3, 3>().transpose();
  for (int i = 0; i < 3; ++i) {
    const double length = R.col(i).norm();
    if (!(length > 0) || !std::isfinite(length)) raise(L, "{} has no rotation in it", what);
    R.col(i) /= length;
  }
  return {matrix.row(3).head<3>().transpose(), Quaterniond(R).normalized()};
}

void add_matrix_words(lua_State* L) {
  push_metatable<Matrix>(L);
  set_function<multiply, Charge::call>(L, "__mul");
  set_function<element, Charge::call>(L, "__call");
  set_function<matrices_equal, Charge::call>(L, "__eq");
  set_function<matrix_text, Charge::call>(L, "__tostring");
  lua_newtable(L);
  set_function<make_translate, Charge::call>(L, "makeTranslate");
  set_function<make_rotate, Charge::call>(L, "makeRotate");
  set_function<make_scale, Charge::call>(L, "makeScale");
  set_function<make_identity, Charge::call>(L, "makeIdentity");
  set_function<set_translation, Charge::call>(L, "setTrans");
  set_function<get_translation, Charge::call>(L, "getTrans");
  set_function<get_rotation, Charge::call>(L, "getRotate");
  set_function<get_scale, Charge::call>(L, "getScale");
  set_function<pre_multiply, Charge::call>(L, "preMult");
  set_function<post_multiply, Charge::call>(L, "postMult");
  set_function<set_product, Charge::call>(L, "mult");
  set_function<inverse, Charge::call>(L, "inverse");
  set_function<invert, Charge::call>(L, "invert");
  lua_setfield(L, -2, "__index");
  lua_pop(L, 1);

  lua_getglobal(L, "osg");
  for (const char* name : {"Matrix", "Matrixd", "Matrixf"}) {
    lua_newtable(L);
    set_function<identity, Charge::call>(L, "identity");
    set_function<translate, Charge::call>(L, "translate");
    set_function<rotate, Charge::call>(L, "rotate");
    set_function<scale, Charge::call>(L, "scale");
    lua_newtable(L);
    set_function<called, Charge::call>(L, "__call");
    lua_setmetatable(L, -2);
    lua_setfield(L, -2, name);
  }
  lua_pop(L, 1);
}

}  // namespace verisim::script
