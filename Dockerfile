# The program alone, on Debian:
#   docker build -t rockproof .
#   docker run --rm -v "$PWD:/work" rockproof examine model.dda
FROM rust:1.90-bookworm AS build
WORKDIR /rockproof
COPY . .
RUN cargo build --release --locked

FROM debian:bookworm-slim
COPY --from=build /rockproof/target/release/rockproof /usr/local/bin/rockproof
WORKDIR /work
ENTRYPOINT ["rockproof"]
