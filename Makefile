# Everything a newcomer needs: `make demo`, `make test`, `make bench`.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
RUST_SOURCES := Cargo.toml Cargo.lock $(shell find crates -name '*.rs' -o -name Cargo.toml)
export CARGO_TERM_COLOR ?= auto
export PIP_DISABLE_PIP_VERSION_CHECK = 1

.PHONY: demo figures test test-rust test-python bench many peers long format clean

demo: $(VENV)/.installed
	$(BIN)/asperity demo --out out/demo

figures: $(VENV)/.installed
	$(BIN)/asperity figures --out out/figures

test: test-rust test-python

test-rust:
	cargo fmt --all --check
	cargo clippy --workspace --all-targets --locked -- -D warnings
	cargo test --locked --quiet
	RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --locked --quiet

test-python: $(VENV)/.installed
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/python -m mypy.stubtest asperity._core --ignore-disjoint-bases
	$(BIN)/pytest --numprocesses auto

bench: $(VENV)/.installed
	cargo bench --locked
	$(BIN)/python benches/python_overhead.py
	$(BIN)/python benches/python_sets.py
	$(BIN)/python benches/python_stability.py
	$(BIN)/python benches/python_identification.py
	$(BIN)/python benches/python_tracking.py

# Time and memory of the default solver, from 10 to 10⁵ contacts.
many: $(VENV)/.installed
	$(BIN)/python benches/many_contacts.py

# The same problems through other engines; PROBLEMS names a folder of problem files, absent engines are
# named with what to install.
peers: $(VENV)/.installed
	$(BIN)/python benches/peers/compare.py $(PROBLEMS) --csv out/peers.csv

# The long profile: 10⁵ random cases per set, 10⁶ one-contact problems per law, 1000 problems of many
# contacts.
long: $(VENV)/.installed
	PROPTEST_CASES=100000 cargo test --release --locked -p asperity-set
	cargo test --release --locked -p asperity -- --ignored
	$(BIN)/pytest --numprocesses auto --timeout 7200 -m long

format:
	cargo fmt --all
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

clean:
	rm -rf target $(VENV) out

# The Rust library is rebuilt whenever its sources change: an editable install alone would keep a
# stale one.
$(VENV)/.installed: $(VENV)/.created $(RUST_SOURCES) pyproject.toml
	$(BIN)/pip install --quiet --editable '.[dev]'
	touch $@

$(VENV)/.created:
	$(PYTHON) -c 'import sys; sys.exit("Python 3.11 or newer is needed" if sys.version_info < (3, 11) else 0)'
	$(PYTHON) -m venv $(VENV)
	touch $@
