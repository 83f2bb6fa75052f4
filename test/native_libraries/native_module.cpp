// The same as a module of Python: it is called with the interpreter's lock held.
#define PY_SSIZE_T_CLEAN
#include <Python.h>

#include "native_sources.h"

namespace {

PyObject* say(PyObject*, PyObject* arguments) {
  const char* topic = nullptr;
  return PyArg_ParseTuple(arguments, "s", &topic) != 0 ? PyUnicode_FromString(ask(topic).c_str())
                                                       : nullptr;
}

PyMethodDef methods[] = {{"ask", &say, METH_VARARGS, "Return what the machine says of a topic."},
                         {nullptr, nullptr, 0, nullptr}};
PyModuleDef module = {PyModuleDef_HEAD_INIT,
                      "native_module",
                      nullptr,
                      -1,
                      methods,
                      nullptr,
                      nullptr,
                      nullptr,
                      nullptr};

}  // namespace

PyMODINIT_FUNC PyInit_native_module() { return PyModule_Create(&module); }
