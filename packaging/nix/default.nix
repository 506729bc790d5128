# nix-build packaging/nix. The program and its libraries, without Python; not built yet. `vega` is a folder with Vega 5's
# modules laid out as in Debian's libjs-vega.
{ pkgs ? import <nixpkgs> { }, vega }:
pkgs.stdenv.mkDerivation {
  pname = "wheeltap";
  version = "0.1.0";
  src = pkgs.lib.cleanSource ../..;
  nativeBuildInputs = with pkgs; [ cmake ninja pkg-config ];
  buildInputs = with pkgs; [
    eigen spectra suitesparse boost random123 netcdf hdf5 nlohmann_json valijson cli11 spdlog httplib matio zlib expat
    cgal gmp mpfr
  ];
  cmakeFlags = [
    "-DWHEELTAP_TESTS=OFF" "-DWHEELTAP_BENCH=OFF" "-DWHEELTAP_EXAMPLES=OFF" "-DWHEELTAP_WITH_PYTHON=OFF"
    "-DWHEELTAP_VEGA_DIR=${vega}"
  ];
  meta = {
    description = "Structural health monitoring with honest probabilities";
    license = with pkgs.lib.licenses; [ bsd3 gpl3Plus ];
    mainProgram = "wheeltap";
    platforms = pkgs.lib.platforms.linux;
  };
}
