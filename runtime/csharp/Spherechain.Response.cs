// SPDX-License-Identifier: MIT
// Collision response: joint rotations in, corrected ones out, frame by frame. docs/response.md is the guide.
using System;
using System.Threading;

namespace Spherechain
{
    /// <summary>A state holds what a response remembers of one character's frames before. A new one remembers nothing.</summary>
    public sealed class ResponseState
    {
        /// <summary>To save and to send them. A copy replays the same, bit for bit, on every machine.</summary>
        public readonly ulong[] Words = new ulong[Native.ResponseWords];

        /// <summary>Forgets everything: where the animation cuts, or the character is moved elsewhere.</summary>
        public void Reset() { Array.Clear(Words, 0, Words.Length); }
        public void CopyFrom(ResponseState other) { Array.Copy(other.Words, Words, Words.Length); }
    }

    /// <summary>The options of a frame, and what is said of it. Set Seconds; the rest may stay as default(ResponseFrame) has it.</summary>
    public struct ResponseFrame
    {
        /// <summary>The place of the roots in the world; null: the identity.</summary>
        public JointTransform? Place;
        public float[] MorphWeights;
        /// <summary>Since the last frame; 0 is a pause, in which nothing turns on.</summary>
        public float Seconds;
        /// <summary>From 0, the full response, to 1, none: to fade it.</summary>
        public float Weakness;
        /// <summary>The most times that contacts are looked for, up to 16; 0: 3.</summary>
        public int Rounds;
        /// <summary>Null, or where the joints will be AheadFrames later, from 1 to 3. Give it in every frame of a state, or in none.</summary>
        public JointTransform[] Ahead;
        public int AheadFrames;
        /// <summary>Other characters and props to stay out of, in their poses; at most 8, always in this order.</summary>
        public Body[] Others;
        public Ground? Ground;
        /// <summary>Joints that stay where they are animated, at most 4. Joints that turn themselves keep their direction, too.</summary>
        public uint[] Planted;
        public Target Target;

        /// <summary>Answer: how many joints were turned; 0: the joints are as they were, bit for bit.</summary>
        public int Turned;
        /// <summary>Answer: how many were not turned as far as wanted.</summary>
        public int AtBudget;
        /// <summary>Answer: the sum of Penetration.FaultDepth that is left, as far as it is known.</summary>
        public float Remaining;
    }

    /// <summary>Turns upper arms, forearms and hands out of the body. It asks a body, whose pose it sets. Both serve any number of
    /// characters of their model in turn, one thread at a time.</summary>
    public sealed unsafe class Response : IDisposable
    {
        const int kOthersMax = 8;

        IntPtr handle;
        int busy;
        readonly int jointCount;
        readonly Results<ContactRow> rows = new Results<ContactRow>();

        public Body Body { get; private set; }
        /// <summary>For calls of Native.</summary>
        public IntPtr Handle { get { return handle; } }
        /// <summary>Spots that are to stay apart, in the corrected pose of the last frame: for a solver of your own.</summary>
        public Results<ContactRow> Rows { get { return rows; } }

        /// <summary>`parents`: of each joint of the model, before or after it; Native.NoJoint: it has none. `mobility`: how easily each
        /// joint turns, from 0, never, to 1; null: arms and hands. `budget`: the most that each is turned, in radians, up to 2; null: 60
        /// degrees. `hinges`: the axis about which each joint bends, in its parent's space; null: elbows' own. `partPairs`: Model.PairSet() of the parts that are kept apart; null: those that a turn can move against each
        /// other. `rule`: what is a fault; null: Native.sc_default_rule().</summary>
        public Response(Body body, uint[] parents, float[] mobility = null, float[] budget = null, ulong[] partPairs = null,
                        Rule? rule = null, Vec3[] hinges = null)
        {
            Text.Require(body, Field.Bodies, "the body");
            Text.Require(parents, Field.Parents, "the list of parents");
            Body = body;
            jointCount = parents.Length;
            CheckLength(mobility == null ? jointCount : mobility.Length, Field.Joints, "fewer mobilities than parents");
            CheckLength(budget == null ? jointCount : budget.Length, Field.Joints, "fewer budgets than parents");
            CheckLength(hinges == null ? jointCount : hinges.Length, Field.Joints, "fewer hinges than parents");
            Body.CheckBits(partPairs, body.Model.PartCount * body.Model.PartCount, Field.PartPairs, "a bit for each two parts: Model.PairSet()");
            Rule limits = rule.GetValueOrDefault();
            body.Enter(false);
            try
            {
                fixed (uint* above = jointCount == 0 ? new uint[1] : parents)
                fixed (float* mobilities = mobility, budgets = budget)
                fixed (Vec3* axes = hinges)
                fixed (ulong* pairs = partPairs)
                fixed (IntPtr* made = &handle)
                {
                    Native.ResponseDef def = default(Native.ResponseDef);
                    def.Parents = above;
                    def.JointCount = Text.Size(jointCount);
                    def.Mobility = mobilities;
                    def.Budget = budgets;
                    def.Hinges = axes;
                    def.PartPairs = pairs;
                    def.Rule = rule.HasValue ? &limits : null;
                    Text.Check(Native.sc_create_response(body.Handle, &def, made));
                }
            }
            finally { body.Leave(false); }
        }

        /// <summary>One frame. `joints`: where each joint is in its parent's space, as animated; the rotations of those that turn are
        /// replaced. On an exception joints and state are as they were.</summary>
        public void Respond(ResponseState state, JointTransform[] joints, ref ResponseFrame frame)
        {
            Text.Require(state, Field.Output, "the state");
            Text.Require(joints, Field.Joints, "the list of joints");
            CheckLength(joints.Length, Field.Joints, "fewer joints than parents");
            CheckLength(frame.Ahead == null ? jointCount : frame.Ahead.Length, Field.Joints, "fewer joints ahead than parents");
            if (frame.Rounds < 0 || frame.AheadFrames < 0) throw new SpherechainException(Code.BadValue, Field.Query, "a number is below 0");
            int others = frame.Others == null ? 0 : frame.Others.Length;
            if (others > kOthersMax) throw new SpherechainException(Code.BadValue, Field.Bodies, "at most 8 others");
            for (int i = 0; i < others; ++i)
            {
                Text.Require(frame.Others[i], Field.Bodies, "another body");
                if (frame.Others[i] == Body) throw new SpherechainException(Code.BadValue, Field.Bodies, "a body meets another one");
            }
            Enter();
            try
            {
                Body.Enter(true);
                int read = 0;
                try
                {
                    for (; read < others; ++read) frame.Others[read].BeginRead();
                    RespondNative(state, joints, ref frame, others);
                }
                finally
                {
                    while (read > 0) frame.Others[--read].EndRead();
                    Body.Leave(true);
                }
            }
            finally { Leave(); }
        }

        void RespondNative(ResponseState state, JointTransform[] joints, ref ResponseFrame frame, int others)
        {
            IntPtr* bodies = stackalloc IntPtr[kOthersMax];
            for (int i = 0; i < others; ++i) bodies[i] = frame.Others[i].Handle;
            fixed (ulong* words = state.Words)
            fixed (JointTransform* own = joints, ahead = frame.Ahead)
            fixed (float* weights = frame.MorphWeights)
            fixed (uint* planted = frame.Planted)
            {
                JointTransform place = frame.Place.GetValueOrDefault();
                Ground plane = frame.Ground.GetValueOrDefault();
                Native.Ground ground = default(Native.Ground);
                ground.Up = plane.Up;
                ground.Height = plane.Height;
                Native.ResponseFrame f = default(Native.ResponseFrame);
                f.Joints = own;
                f.Place = frame.Place.HasValue ? &place : null;
                f.MorphWeights = weights;
                f.MorphWeightCount = Text.Size(weights == null ? 0 : frame.MorphWeights.Length);
                f.Seconds = frame.Seconds;
                f.Weakness = frame.Weakness;
                f.Rounds = (uint)frame.Rounds;
                f.Ahead = ahead;
                f.AheadFrames = (uint)frame.AheadFrames;
                f.Others = bodies;
                f.OtherCount = Text.Size(others);
                f.Ground = frame.Ground.HasValue ? &ground : null;
                f.Planted = planted;
                f.PlantedCount = Text.Size(planted == null ? 0 : frame.Planted.Length);
                f.Target = frame.Target;
                Text.Check(Native.sc_respond(handle, words, &f));
                frame.Turned = (int)f.Turned;
                frame.AtBudget = (int)f.AtBudget;
                frame.Remaining = f.Remaining;
                rows.CopyFrom(f.Rows, f.RowCount, f.RowCount);
            }
        }

        void CheckLength(int length, Field field, string what)
        {
            if (length < jointCount) throw new SpherechainException(Code.TooSmall, field, what);
        }

        void Enter()
        {
            if (Interlocked.CompareExchange(ref busy, 1, 0) != 0)
            {
                throw new SpherechainException(Code.Aliased, Field.Bodies, "the response is in use: make one a thread");
            }
            if (handle != IntPtr.Zero) return;
            Volatile.Write(ref busy, 0);
            throw new SpherechainException(Code.NotOpen, Field.Bodies, "the response is disposed");
        }

        void Leave()
        {
            Volatile.Write(ref busy, 0);
            GC.KeepAlive(this);
        }

        /// <summary>Its body stays.</summary>
        public void Dispose()
        {
            if (handle == IntPtr.Zero) return;
            Enter();
            Free();
            Leave();
            GC.SuppressFinalize(this);
        }

        void Free()
        {
            if (handle != IntPtr.Zero) Native.sc_destroy_response(handle);
            handle = IntPtr.Zero;
        }

        ~Response() { Free(); }
    }
}
