// marti/marti.h as the Python module marti._marti. What makes it pleasant in Python is
// python/marti/__init__.py.
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>

#include "marti/marti.h"

namespace py = pybind11;

namespace {

/// Lets Python's signal handlers run; Ctrl-C becomes KeyboardInterrupt, which ends the work.
bool signals_allow() {
  const py::gil_scoped_acquire gil;
  if (PyErr_CheckSignals() != 0) {
    throw py::error_already_set();
  }
  return true;
}

py::array_t<float> array_of(const marti::Image& image) {
  py::array_t<float> array({py::ssize_t{image.height}, py::ssize_t{image.width}, py::ssize_t{3}});
  std::copy(image.rgb.begin(), image.rgb.end(), array.mutable_data());
  return array;
}

/// A value as Python has it; None where a machine lacks the figure.
py::object object_of(const marti::Value& value) {
  return std::holds_alternative<std::monostate>(value) ? py::object(py::none()) : py::cast(value);
}

py::list rows_of(const marti::Table& table) {
  py::list rows;
  for (const std::vector<marti::Value>& row : table.rows) {
    py::tuple cells(row.size());
    for (std::size_t i = 0; i < row.size(); ++i) {
      cells[i] = object_of(row[i]);
    }
    rows.append(std::move(cells));
  }
  return rows;
}

}  // namespace

PYBIND11_MODULE(_marti, module) {
  using WithoutGil = py::call_guard<py::gil_scoped_release>;

  static const py::handle error = PyErr_NewException("marti.Error", PyExc_ValueError, nullptr);
  for (const char* const part : {"file", "line", "key"}) {
    py::reinterpret_borrow<py::object>(error).attr(part) = py::none();
  }
  module.attr("Error") = error;
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      std::rethrow_exception(std::move(thrown));
    } catch (const marti::Error& wrong) {
      const py::object instance = py::reinterpret_borrow<py::object>(error)(wrong.what());
      instance.attr("file") = wrong.file().empty() ? py::object(py::none()) : py::str(wrong.file());
      instance.attr("line") = wrong.line() == 0 ? py::object(py::none()) : py::int_(wrong.line());
      instance.attr("key") = wrong.key().empty() ? py::object(py::none()) : py::str(wrong.key());
      PyErr_SetObject(error.ptr(), instance.ptr());
    }
  });

  py::class_<marti::Column>(module, "Column")
      .def_readonly("name", &marti::Column::name)
      .def_readonly("unit", &marti::Column::unit)
      .def_readonly("meaning", &marti::Column::meaning);
  py::class_<marti::Table>(module, "Table")
      .def_readonly("name", &marti::Table::name)
      .def_readonly("title", &marti::Table::title)
      .def_readonly("columns", &marti::Table::columns)
      .def_property_readonly("rows", &rows_of);
  py::class_<marti::Result>(module, "Result")
      .def("figure", [](const marti::Result& result,
                        const std::string& name) { return object_of(result.figure(name)); })
      .def("figures", &marti::Result::figures)
      .def("settings", &marti::Result::settings)
      .def("json", &marti::Result::json)
      .def("summary", &marti::Result::summary)
      .def("image",
           [](const marti::Result& result) {
             const marti::Image image = [&] {
               const py::gil_scoped_release released;
               return result.image();
             }();
             return array_of(image);
           })
      .def("ray_hits",
           [](const marti::Result& result) {
             const std::string file = [&] {
               const py::gil_scoped_release released;
               return result.ray_hits();
             }();
             return py::bytes(file);
           })
      .def("report", &marti::Result::report, WithoutGil())
      .def("directory", &marti::Result::directory)
      .def("save", &marti::Result::save, WithoutGil());
  py::class_<marti::Sweep>(module, "Sweep")
      .def("points", &marti::Sweep::points)
      .def("axes", &marti::Sweep::axes)
      .def("best", &marti::Sweep::best, WithoutGil())
      .def("summary", &marti::Sweep::summary)
      .def("tables", &marti::Sweep::tables)
      .def("directory", &marti::Sweep::directory)
      .def("complete", &marti::Sweep::complete)
      .def("report", &marti::Sweep::report, WithoutGil());
  py::class_<marti::Study>(module, "Study")
      .def("tables", &marti::Study::tables)
      .def("summary", &marti::Study::summary)
      .def("report", &marti::Study::report, WithoutGil());

  module.def(
      "run",
      [](const std::string& config, const marti::Settings& settings, const std::string& directory) {
        return marti::run(config, settings, directory, signals_allow);
      },
      WithoutGil());
  module.def(
      "sweep",
      [](const std::string& config, const std::vector<std::string>& axes, const marti::Settings& settings,
         const std::string& directory, unsigned threads, const std::string& share) {
        return marti::sweep(config, axes, {directory, settings, threads, share}, signals_allow);
      },
      WithoutGil());
  module.def("open", &marti::open, WithoutGil());
}
