# The program alone, on Debian:
#   docker build -t rockproof .
#   docker run --rm -v "$PWD:/work" rockproof examine model.dda
# The first stage alone has cargo and the sources, for both commands of README.md:
#   docker build --target build -t rockproof-build .
#   docker run --rm rockproof-build cargo run --release -- campaign
#   docker run --rm rockproof-build cargo test --release
FROM rust:1.90-bookworm AS build
WORKDIR /rockproof
COPY . .
RUN cargo build --release --locked

FROM debian:bookworm-slim
COPY --from=build /rockproof/target/release/rockproof /usr/local/bin/rockproof
WORKDIR /work
ENTRYPOINT ["rockproof"]
